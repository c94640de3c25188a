// Not a frame of the gyro's 1 kHz is lost or repeated on its way into the run log, however busy the
// machine is. Only real time, a real serial line and other processes can show that: the stream is
// served by another program on a pseudo-terminal, the real driver reads it, a run records it, and
// every core has something else to do all the while. The run's other instruments are in memory,
// since the USB ones need a kernel that takes them (tests/system/kernel).
//
// ctest runs it for five seconds, and with the label `soak`, by hand, for ten minutes. On a virtual
// machine of two cores the ten minutes gave 600297 frames, none lost, none repeated; the two busy
// loops had 1088 s of processor time.

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "daemon/session.hpp"
#include "daemon/simulated_operator.hpp"
#include "drivers/open_bench.hpp"
#include "drivers/open_ports.hpp"
#include "record/run_log.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;

double wanted_duration_s() {
  const char* const seconds = std::getenv("FOGBENCH_SOAK_S");
  return seconds == nullptr ? 5.0 : std::atof(seconds);
}

/// A loop for every hardware thread, none of which outlives the test.
class BusyCores {
 public:
  BusyCores() {
    const Process::Setup mortal{{}, [] { prctl(PR_SET_PDEATHSIG, SIGKILL); }};
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
      loops_.push_back(std::make_unique<Process>(
          std::vector<std::string>{"/bin/sh", "-c", "while :; do :; done"}, mortal));
    }
  }
  /// Ends them; the processor time that they have had.
  double end_s() {
    loops_.clear();
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    return static_cast<double>(used.ru_utime.tv_sec) +
           1e-6 * static_cast<double>(used.ru_utime.tv_usec);
  }

 private:
  std::vector<std::unique_ptr<Process>> loops_;
};

/// The first column of the raw export in frames; not a row is left out.
std::vector<std::int64_t> exported_frames(const std::string& csv, double frame_rate_hz) {
  std::vector<std::int64_t> frames;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.substr(0, 7), "time_s,");
  while (std::getline(lines, line)) {
    frames.push_back(std::llround(std::atof(line.c_str()) * frame_rate_hz));
  }
  return frames;
}

using GyroSoak = FogbenchTest;

TEST_F(GyroSoak, LosesAndRepeatsNoFrameOnBusyCores) {
  const double duration_s = wanted_duration_s();
  Process served(command({"simulate", "--serve", "--bench", "simulated-1khz", "--modbus-port", "0",
                          "--usbip-port", "0", "--seed", "1", "--json"}));
  ASSERT_TRUE(served.wait_for_output("\n}\n", 30s)) << served.output();
  const std::string line =
      nlohmann::json::parse(served.output())["instruments"]["gyro"]["connection"];

  const auto setup = daemon::load_setup({.bench = "simulated-1khz"});
  ASSERT_TRUE(setup) << setup.error().message;
  const auto planned = daemon::plan_procedure("static-record", setup->bench,
                                              {{"duration_s", duration_s}, {"average_s", 1.0}});
  ASSERT_TRUE(planned) << planned.error().message;
  drivers::SteadyClock clock;
  auto transports = simulator::simulate_bench(setup->bench, setup->scenario, 1, clock);
  ASSERT_TRUE(transports) << transports.error().message;
  auto port = drivers::open_port(setup->bench.gyro.device, line, clock);
  ASSERT_TRUE(port) << port.error().message;
  transports->gyro = std::move(*port);

  BusyCores busy;
  daemon::SimulatedOperator nobody;
  auto bench = drivers::open_bench(setup->bench, std::move(*transports), clock, nobody);
  ASSERT_TRUE(bench) << bench.error().message;
  const double frame_rate_hz = bench->gyro->frame_rate_hz();
  ASSERT_EQ(frame_rate_hz, 1000.0);
  {
    auto log = record::RunLog::open(store());
    ASSERT_TRUE(log) << log.error().message;
    procedures::RunEngine engine(setup->bench, *bench, clock, nobody, **log);
    procedures::RunHeader header;
    header.procedure = "static-record";
    header.bench = "simulated-1khz";
    header.frame_rate_hz = frame_rate_hz;
    const auto summary = engine.run(planned->plan, header);
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->end.outcome, procedures::RunOutcome::kCompleted) << summary->end.reason;
  }
  const double busy_s = busy.end_s();

  const Finished raw = fogbench({"export", "1", "--raw", "--store", store()});
  ASSERT_EQ(raw.status, 0) << raw.err;
  const auto frames = exported_frames(raw.out, frame_rate_hz);
  ASSERT_GE(static_cast<double>(frames.size()), duration_s * frame_rate_hz);
  std::int64_t lost = 0, repeated = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const std::int64_t step = frames[i] - frames[i - 1];
    lost += std::max<std::int64_t>(step - 1, 0);
    repeated += step < 1;
  }
  const drivers::StreamStatistics& stream = bench->gyro->statistics();
  fmt::print(
      "{} frames in the log, {} lost, {} repeated; {} with a wrong check value; {} busy loops "
      "had {:.0f} s of processor time\n",
      frames.size(), lost, repeated, stream.frames_bad_checksum,
      std::thread::hardware_concurrency(), busy_s);
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(repeated, 0);
  EXPECT_EQ(stream.frames_missing, 0U);
  EXPECT_EQ(stream.frames_repeated, 0U);
  EXPECT_EQ(stream.frames_bad_checksum, 0U);
  EXPECT_EQ(stream.frames_invalid, 0U);
  // The machine was busy indeed: its cores were never idle for long.
  EXPECT_GT(busy_s, 0.25 * duration_s);
  // And no event says otherwise than that it began and ended.
  for (const auto& event : json({"show", "1", "--store", store(), "--json"})["events"]) {
    EXPECT_EQ(event["severity"], "info") << event;
  }
}

}  // namespace
}  // namespace fogbench::system_tests
