#include "daemon/queue_file.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "config/json_file.hpp"
#include "config/output_file.hpp"
#include "daemon/parameters_json.hpp"
#include "record/store.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::ordered_json;

struct Kept {
  Order order;
  Person by;
};

std::optional<Kept> kept_from(const nlohmann::json& entry) {
  if (!entry.is_object() || !entry.contains("by") || !entry["by"].is_string() ||
      !entry.contains("uid") || !entry["uid"].is_number_unsigned()) {
    return std::nullopt;
  }
  Kept kept;
  kept.by = {entry["by"].get<std::string>(), entry["uid"].get<std::uint32_t>()};
  if (const auto job = entry.find("job"); job != entry.end()) {
    if (!job->is_number_unsigned()) return std::nullopt;
    kept.order.job = job->get<std::uint64_t>();
  }
  if (const auto since = entry.find("gyro_on_since_unix_s"); since != entry.end()) {
    const auto by = entry.find("gyro_on_since_by");
    if (!since->is_number() || by == entry.end() || !by->is_string()) return std::nullopt;
    kept.order.switched_on = SwitchedOn{since->get<double>(), by->get<std::string>()};
  }
  if (const auto run = entry.find("takes_up"); run != entry.end()) {
    if (!run->is_number_unsigned()) return std::nullopt;
    kept.order.takes_up = run->get<std::int64_t>();
    return kept;  // a person's order to go on: no failure before it counts
  }
  if (!entry.contains("procedure") || !entry["procedure"].is_string() || !entry.contains("set")) {
    return std::nullopt;
  }
  auto set = parameters_of(entry["set"]);
  if (!set) return std::nullopt;
  kept.order.procedure = entry["procedure"].get<std::string>();
  kept.order.set = std::move(*set);
  if (const auto gyro = entry.find("gyro"); gyro != entry.end()) {
    if (!gyro->is_string() || !is_serial_number(gyro->get_ref<const std::string&>())) {
      return std::nullopt;
    }
    kept.order.gyro = gyro->get<std::string>();
  }
  if (const auto goes_on = entry.find("keep_going"); goes_on != entry.end()) {
    if (!goes_on->is_boolean()) return std::nullopt;
    kept.order.keep_going = goes_on->get<bool>();
  }
  return kept;
}

std::string title_of(const Order& order) {
  return order.takes_up == 0 ? order.procedure : fmt::format("taking up run {}", order.takes_up);
}

}  // namespace

Result<QueueFile> QueueFile::open(const std::filesystem::path& store) {
  record::make_default_folder(store);
  auto serving = drivers::ProcessLock::take(record::beside_store(store, ".serving"), 0644,
                                            "run log " + store.string());
  if (!serving) return serving.error();
  return QueueFile(record::beside_store(store, ".queue"), std::move(*serving));
}

Status QueueFile::load(RunDesk& desk, const Setup& setup, const std::filesystem::path& store) {
  std::error_code error;
  if (!std::filesystem::exists(path_, error)) return {};
  const auto document = config::read_json_file(path_);
  if (!document) return document.error();
  // A list alone is what earlier versions wrote.
  const nlohmann::json none;
  const nlohmann::json& jobs = document->is_object() ? document->value("jobs", none) : *document;
  const nlohmann::json hold = document->is_object() ? document->value("hold", none) : none;
  if (!jobs.is_array()) {
    return config::bad_input(path_.string() + ": expected a list of the runs that wait");
  }
  if (!hold.is_null() && !hold.is_string()) {
    return config::bad_input(path_.string() + ": /hold: expected why the queue is held");
  }
  if (document->is_object()) {
    const nlohmann::json last = document->value("last_job", nlohmann::json(0U));
    if (!last.is_number_unsigned()) {
      return config::bad_input(path_.string() + ": /last_job: expected the number of a job");
    }
    desk.restore_count(last.get<std::uint64_t>());
  }
  if (hold.is_string()) desk.restore_hold(hold.get<std::string>());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto kept = kept_from(jobs[i]);
    if (!kept) {
      return config::bad_input(
          fmt::format("{}: job {}: expected procedure, set, by, uid and perhaps job, gyro "
                      "and keep_going of a run that waits",
                      path_.string(), i + 1));
    }
    auto planned = plan_order(kept->order, setup, store, credentials_of_user(kept->by.uid));
    if (!planned) {
      spdlog::warn("{}, asked for by {}, is no longer in the queue: {}", title_of(kept->order),
                   kept->by.name, planned.error().message);
      continue;
    }
    desk.restore(kept->order, std::move(*planned), kept->by);
  }
  return {};
}

void QueueFile::update(const RunDesk& desk) {
  const JobQueue::Waiting waiting = desk.waiting();
  if (waiting.changes == written_) return;
  const Status written = write(waiting);
  if (written) {
    written_ = waiting.changes;
  } else if (!failing_) {
    spdlog::warn("the queue would not outlive the daemon: {}", written.error().message);
  }
  failing_ = !written;
}

Status QueueFile::write(const JobQueue::Waiting& waiting) const {
  std::error_code error;
  if (waiting.orders.empty() && waiting.asked_hold.empty() && waiting.jobs_ever == 0) {
    std::filesystem::remove(path_, error);
    if (!error) return {};
    return config::bad_input(fmt::format("{}: {}", path_.string(), error.message()));
  }
  ordered_json list = ordered_json::array();
  for (const auto& [order, by] : waiting.orders) {
    ordered_json entry;
    if (order.job != 0) entry["job"] = order.job;
    if (order.takes_up != 0) {
      entry["takes_up"] = order.takes_up;
    } else {
      entry["procedure"] = order.procedure;
      entry["set"] = to_json(order.set);
      if (!order.gyro.empty()) entry["gyro"] = order.gyro;
    }
    if (order.keep_going) entry["keep_going"] = true;
    if (order.switched_on) {
      entry["gyro_on_since_unix_s"] = order.switched_on->unix_s;
      entry["gyro_on_since_by"] = order.switched_on->by;
    }
    entry["by"] = by.name;
    entry["uid"] = by.uid;
    list.push_back(std::move(entry));
  }
  ordered_json document{{"jobs", std::move(list)}, {"last_job", waiting.jobs_ever}};
  if (!waiting.asked_hold.empty()) document["hold"] = waiting.asked_hold;
  constexpr auto kReplace = ordered_json::error_handler_t::replace;
  return config::write_file(path_, document.dump(2, ' ', false, kReplace) + "\n");
}

}  // namespace fogbench::daemon
