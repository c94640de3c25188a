#include "daemon/order.hpp"

#include <fmt/format.h>

#include "config/json_file.hpp"
#include "config/paths.hpp"
#include "daemon/resumption.hpp"

namespace fogbench::daemon {

namespace {

Result<PlannedProcedure> plan_named(const Order& order, const Setup& setup,
                                    const Credentials& reader) {
  if (!order.procedure.starts_with('/')) {
    const auto ready = config::find_ready("procedures", order.procedure);
    if (!ready && order.procedure.find('/') != std::string::npos) {
      return config::bad_input(
          fmt::format("{}: expected a ready procedure's name, or the file's full path",
                      config::one_line(order.procedure)));
    }
    if (!ready) return ready.error();
    return plan_procedure(ready->string(), setup.bench, order.set);
  }
  const BorrowedRights rights(reader);
  if (!rights.taken()) {
    return config::bad_input(fmt::format("{}: cannot be read with the rights of {}",
                                         order.procedure, user_name(reader.uid)));
  }
  return plan_procedure(order.procedure, setup.bench, order.set);
}

}  // namespace

Result<PlannedProcedure> plan_order(const Order& order, const Setup& setup,
                                    const std::filesystem::path& store, const Credentials& reader) {
  if (order.takes_up == 0) {
    auto planned = plan_named(order, setup, reader);
    if (planned && !order.gyro.empty()) planned->gyro = order.gyro;
    if (planned) planned->switched_on = order.switched_on;
    return planned;
  }
  const auto log = record::RunLogReader::open(store);
  if (!log) return log.error();
  auto planned = plan_resumption(**log, order.takes_up, setup);
  if (planned) planned->switched_on = order.switched_on;
  return planned;
}

bool is_serial_number(std::string_view text) {
  constexpr std::size_t kLongestNumber = 64;
  return !text.empty() && text.size() <= kLongestNumber && text.front() != ' ' &&
         text.back() != ' ' && config::one_line(text, kLongestNumber) == text;
}

}  // namespace fogbench::daemon
