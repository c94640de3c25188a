#include "daemon/order.hpp"

#include "config/json_file.hpp"
#include "daemon/resumption.hpp"

namespace fogbench::daemon {

Result<PlannedProcedure> plan_order(const Order& order, const Setup& setup,
                                    const std::filesystem::path& store) {
  if (order.takes_up == 0) {
    auto planned = plan_procedure(order.procedure, setup.bench, order.set);
    if (planned && !order.gyro.empty()) planned->gyro = order.gyro;
    return planned;
  }
  const auto log = RunLogReader::open(store);
  if (!log) return log.error();
  return plan_resumption(**log, order.takes_up, setup);
}

bool is_serial_number(std::string_view text) {
  constexpr std::size_t kLongestNumber = 64;
  return !text.empty() && text.size() <= kLongestNumber && text.front() != ' ' &&
         text.back() != ' ' && config::one_line(text, kLongestNumber) == text;
}

}  // namespace fogbench::daemon
