// A client of the control socket that sends anything: the line is a request, or it is refused with
// an answer that is one line of JSON; and what one end formats the other one reads.

#include <string>
#include <variant>

#include "daemon/json_rpc.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

void is_one_line_of_json(const std::string& line) {
  require(!line.empty() && line.find('\n') == line.size() - 1);
  require(nlohmann::json::accept(line));
}

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  const std::string line(reinterpret_cast<const char*>(data), size);
  const auto parsed = daemon::parse_request(line);
  if (const auto* refused = std::get_if<daemon::RpcRefusal>(&parsed)) {
    const std::string answer = daemon::format_error(refused->id, refused->error);
    fuzz::is_one_line_of_json(answer);
    fuzz::require(static_cast<bool>(daemon::parse_answer(answer)));
  } else {
    const auto& request = std::get<daemon::RpcRequest>(parsed);
    fuzz::require(request.params.is_object());
    if (!request.id.empty()) {
      const std::string answer = daemon::format_result(request.id, request.params);
      fuzz::is_one_line_of_json(answer);
      fuzz::require(static_cast<bool>(daemon::parse_answer(answer)));
    }
    fuzz::is_one_line_of_json(daemon::format_notification(request.method, request.params));
  }
  (void)daemon::parse_answer(line);
  return 0;
}
