// A supply that answers anything at all: each line of the input is an answer.

#include <cmath>
#include <cstdlib>

#include "drivers/scpi_coil_supply.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using drivers::Clock;

constexpr double kLimitA = 4.0;

/// "!T", "!P" and "!D" are failures; so is everything after the end.
class Babbler final : public drivers::MessageTransport {
 public:
  explicit Babbler(Input& input) : input_(input) {}
  Status write(std::string_view message) override {
    // Nothing may go on for ever.
    require(++messages_ < 20000);
    require(message.find("TST") == std::string_view::npos);
    if (message.starts_with("CURR ")) {
      const double current_a = std::atof(std::string(message.substr(5)).c_str());
      require(std::abs(current_a) <= kLimitA);
    }
    return input_.empty() ? Status(Error{ErrorCode::kDevice, "gone"}) : Status{};
  }
  Result<std::string> read(Clock::Duration) override {
    std::string text = input_.line();
    if (text == "!T") return Error{ErrorCode::kTimeout, "no answer"};
    if (text == "!P") return Error{ErrorCode::kProtocol, "nonsense"};
    if (text == "!D") return Error{ErrorCode::kDevice, "gone"};
    return text;
  }
  Status clear() override { return {}; }

 private:
  Input& input_;
  int messages_ = 0;
};

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  config::CoilConfig config;
  config.current_limit = config::Ampere{fuzz::kLimitA};
  config.device.identity = "K";
  config.device.initialise = {"*CLS", "VOLT 30"};
  config.device.set = "CURR {value}";
  config.device.set_query = "CURR?";
  config.device.measure_query = "MEAS:CURR?";
  config.device.output_on = "OUTP ON";
  config.device.output_off = "OUTP OFF";
  config.device.minimum = -6.0;
  config.device.maximum = 6.0;
  config.device.resolution = 0.001;
  config.device.read_back_tolerance = 0.01;
  fuzz::Input input(data, size);
  const auto wanted = static_cast<double>(input.number<float>());
  drivers::VirtualClock clock;
  auto supply = drivers::begun(drivers::ScpiCoilSupply::attach(
      "coil", config, std::make_unique<fuzz::Babbler>(input), clock));
  if (!supply) {
    fuzz::require(supply.error().message.starts_with("coil: "));
    return 0;
  }
  (void)(*supply)->enable();
  (void)(*supply)->set_current(config::Ampere{wanted});
  if (const auto reading = (*supply)->read()) {
    fuzz::require(std::isfinite(reading->set.value) && std::isfinite(reading->measured.value));
  }
  (void)(*supply)->switch_off();
  (void)(*supply)->confirm_off();
  return 0;
}
