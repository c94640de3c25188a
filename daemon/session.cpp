#include "daemon/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "config/json_file.hpp"
#include "config/paths.hpp"
#include "config/roles.hpp"
#include "daemon/parameters_json.hpp"
#include "daemon/resumption.hpp"
#include "drivers/open_ports.hpp"
#include "simulator/simulated_bench.hpp"

namespace fogbench::daemon {
namespace fs = std::filesystem;

namespace {

/// {"file.json": "its text"...}: the record holds what was read, to the byte, and no path of this
/// machine.
Result<nlohmann::ordered_json> texts_of(const std::vector<fs::path>& files) {
  nlohmann::ordered_json texts = nlohmann::ordered_json::object();
  for (const fs::path& file : files) {
    auto text = config::read_text_file(file);
    if (!text) return text.error();
    texts[file.filename().string()] = std::move(*text);
  }
  return texts;
}

/// The bench's file and the device files that it names.
Result<std::vector<fs::path>> files_of_bench(const fs::path& file) {
  const auto bench = config::read_json_file(file);
  if (!bench) return bench.error();
  std::set<fs::path> devices;
  const auto take = [&](const auto& instrument) {
    if (!instrument.is_object() || !instrument.contains("device")) return;
    const auto device = config::device_file(file, instrument["device"].template get<std::string>());
    if (device) devices.insert(*device);  // the bench has been read: it is there
  };
  for (const auto& part : *bench) {
    take(part);
    if (!part.is_array()) continue;  // the auxiliary sensors
    for (const auto& sensor : part) take(sensor);
  }
  std::vector<fs::path> files{file};
  files.insert(files.end(), devices.begin(), devices.end());
  return files;
}

/// The procedure's name for the record. Of an edited copy of a ready one, which bears its name too,
/// it says which file it was.
std::string name_of(const procedures::Plan& plan) {
  const auto folder = config::config_directory();
  if (!folder) return plan.procedure;
  const fs::path ready = *folder / "procedures";
  std::error_code ignored;
  if (!fs::is_regular_file(ready / (plan.procedure + ".json"), ignored)) return plan.procedure;
  for (const fs::path& file : plan.files) {
    const bool first = &file == &plan.files.front();
    const auto text = config::read_text_file(file);
    const auto readys = config::read_text_file(
        ready / (first ? fs::path(plan.procedure + ".json") : file.filename()));
    if (text && readys && *text == *readys) continue;
    return fmt::format("{} ({}, not the ready one)", plan.procedure,
                       config::one_line(file.filename().string()));
  }
  return plan.procedure;
}

/// The name of a file may be any bytes; JSON text may not.
std::string text_of(const nlohmann::ordered_json& record) {
  return record.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

Result<Setup> load_setup(const SetupOptions& options) {
  const auto bench_file = config::find_config("benches", options.bench);
  if (!bench_file) return bench_file.error();
  const auto scenario_file = config::find_config("scenarios", options.scenario);
  if (!scenario_file) return scenario_file.error();
  auto bench = config::load_bench(*bench_file);
  if (!bench) return bench.error();
  auto scenario = config::load_scenario(*scenario_file);
  if (!scenario) return scenario.error();

  const auto bench_files = files_of_bench(*bench_file);
  if (!bench_files) return bench_files.error();
  const auto bench_texts = texts_of(*bench_files);
  if (!bench_texts) return bench_texts.error();
  auto scenario_text = config::read_text_file(*scenario_file);
  if (!scenario_text) return scenario_text.error();
  return Setup{std::move(*bench), text_of(*bench_texts), std::move(*scenario),
               std::move(*scenario_text)};
}

Result<bool> is_simulated(const config::BenchConfig& bench) {
  const char* simulated = nullptr;
  const char* real = nullptr;
  const auto look_at = [&](const char* name, const auto& its) {
    if (config::device_of(its) == nullptr) return;
    (its.connection == "simulated" ? simulated : real) = name;
  };
  config::for_each_role(look_at, bench);
  for (const config::AuxiliaryConfig& sensor : bench.auxiliary) {
    look_at(sensor.name.c_str(), sensor);
  }
  if (simulated != nullptr && real != nullptr) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("bench {}: /{}/connection is \"simulated\" and /{}/connection is "
                             "not; expected all of them simulated, or none",
                             bench.name, simulated, real)};
  }
  return real == nullptr;
}

Result<PlannedProcedure> plan_procedure(const std::string& name, const config::BenchConfig& bench,
                                        const Parameters& parameters) {
  const auto file = config::find_config("procedures", name);
  if (!file) return file.error();
  const auto procedure = config::load_procedure(*file);
  if (!procedure) return procedure.error();
  auto plan = procedures::make_plan(*procedure, bench, parameters);
  if (!plan) return plan.error();
  plan->procedure = name_of(*plan);
  const auto texts = texts_of(plan->files);
  if (!texts) return texts.error();
  const nlohmann::ordered_json record{{"files", *texts}, {"parameters", to_json(parameters)}};
  return PlannedProcedure{std::move(*plan), text_of(record), std::nullopt,
                          bench.gyro.serial_number};
}

Result<std::unique_ptr<Session>> Session::attach(Setup setup, std::uint64_t seed, Speed speed,
                                                 drivers::Operator& person) {
  // A gyro without noise stands still by right.
  if (setup.scenario.noise == config::NoiseCoefficients{}) {
    setup.bench.gyro.device.stuck_after.reset();
  }
  std::unique_ptr<Session> session(new Session(std::move(setup), seed, speed, person));
  const Setup& made = session->setup_;
  if (speed == Speed::kMaximum) {
    // Starts today, so that the record's dates mean something; nothing measured depends on it.
    session->clock_ = std::make_unique<drivers::VirtualClock>(drivers::SteadyClock().wall_now());
  } else {
    using drivers::SteadyClock;
    const SteadyClock::WallTime from{std::chrono::floor<std::chrono::milliseconds>(
        std::chrono::duration<double>(made.calendar_from_unix_s))};
    session->clock_ = std::make_unique<SteadyClock>(
        speed.factor, [from] { return std::max(from, SteadyClock::system_calendar()); });
  }
  auto transports =
      made.simulated ? simulator::simulate_bench(made.bench, made.scenario, seed, *session->clock_)
                     : drivers::open_ports(made.bench, *session->clock_);
  if (!transports) return transports.error();
  session->exchange_gyro_ = transports->exchange_gyro;
  auto bench =
      drivers::attach_bench(made.bench, std::move(*transports), *session->clock_, session->person_);
  if (!bench) return bench.error();
  session->bench_ = std::move(*bench);
  return session;
}

void Session::record_in(procedures::Recorder& record) {
  engine_ = std::make_unique<procedures::RunEngine>(setup_.bench, bench_, *clock_, person_, record);
  person_.attach(*engine_);
  line_.emplace(*bench_.gyro, *clock_);
  if (speed_ != Speed::kMaximum) engine_->wait_for_record();
}

Result<std::unique_ptr<Session>> Session::begun(Setup setup, std::uint64_t seed, Speed speed,
                                                drivers::Operator& person) {
  auto session = attach(std::move(setup), seed, speed, person);
  if (!session) return session;
  constexpr int kTries = 3;
  for (int tries = 1;; ++tries) {
    const drivers::SafetyReport safety = (*session)->make_safe();
    const Status begun = (*session)->begin();
    if (safety.reached() && begun) return session;
    if (tries == kTries) {
      const Error error = begun ? safety.status().error() : begun.error();
      return Error{error.code, fmt::format("{} ({})", error.message, safety.text())};
    }
    (*session)->clock_->sleep_for(std::chrono::seconds{1});
  }
}

Result<std::unique_ptr<Session>> Session::open(Setup setup, std::uint64_t seed,
                                               const fs::path& store, Speed speed,
                                               drivers::Operator& person) {
  auto session = begun(std::move(setup), seed, speed, person);
  if (!session) return session;
  // After the bench: one that cannot be reached or simulated leaves nothing behind.
  auto log = record::RunLog::open(store);
  if (!log) return log.error();
  (*session)->log_ = std::move(*log);
  (*session)->record_in(*(*session)->log_);
  return session;
}

Result<std::unique_ptr<Session>> Session::open(Setup setup, std::uint64_t seed,
                                               procedures::Recorder& record, Speed speed,
                                               drivers::Operator& person) {
  auto session = begun(std::move(setup), seed, speed, person);
  if (session) (*session)->record_in(record);
  return session;
}

bool Session::send_last_zero() noexcept {
  if (setup_.simulated) return false;
  bench_.coil_horizontal->send_last_zero();
  bench_.coil_vertical->send_last_zero();
  return true;
}

std::string Session::listen() {
  return line_ ? line_->listen() : std::string();
}

Status Session::take_gyro(const PlannedProcedure& procedure, procedures::RunHeader& header) {
  listen();  // a silence may have ended just now
  const std::string& before = line_->gyro();
  const bool other = !before.empty() && !procedure.gyro.empty() && procedure.gyro != before;
  const bool exchanged = other && exchange_gyro_;
  if (exchanged) exchange_gyro_();
  auto taken = line_->take(procedure.gyro, procedure.switched_on, exchanged);
  if (!taken) return taken.error();
  header.remarks = std::move(taken->remarks);
  if (taken->doubtful) {
    header.question = fmt::format(
        "Gyro {} is to be measured, and the stream has not stopped since gyro {} was: is gyro {} "
        "on the bench?",
        procedure.gyro, taken->before, procedure.gyro);
  }
  return {};
}

Result<procedures::RunSummary> Session::run(const PlannedProcedure& procedure,
                                            const std::string& operator_name) {
  procedures::RunHeader header;
  header.procedure = procedure.plan.procedure;
  header.procedure_json = procedure.procedure_json;
  header.bench = setup_.bench.name;
  header.bench_json = setup_.bench_json;
  header.scenario_json = setup_.scenario_json;
  if (setup_.simulated) header.seed = seed_;
  header.gyro_serial_number = procedure.gyro;
  header.operator_name = operator_name;
  header.software_version = FOGBENCH_VERSION;
  clock_->follow_calendar();
  if (const Status taken = take_gyro(procedure, header); !taken) return taken.error();
  header.started_at = drivers::utc_text(clock_->wall_now());
  header.frame_rate_hz = bench_.gyro->frame_rate_hz();
  header.reference_rate_deg_per_h = setup_.bench.gyro.reference_rate.value;
  for (const config::SensorChannel& channel : config::auxiliary_channels(setup_.bench)) {
    header.auxiliary.push_back({channel.name, channel.meaning});
  }
  if (procedure.takes_up) {
    auto continuation = take_up(procedure, *engine_, *clock_);
    if (!continuation) return continuation.error();
    header.continues = std::move(*continuation);
  }
  auto summary = engine_->run(procedure.plan, header);
  line_->heard();
  return summary;
}

std::uint64_t random_seed() {
  return std::random_device{}();
}

}  // namespace fogbench::daemon
