#include "drivers/scpi_dialogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "config/json_file.hpp"
#include "drivers/named_error.hpp"
#include "drivers/patience.hpp"

namespace fogbench::drivers {
namespace {

using config::one_line;
using namespace std::chrono_literals;

constexpr Clock::Duration kAnswerTimeout = 1s;
constexpr int kQuestions = 2;
/// Queues hold 10 to 30 entries; one that does not end is broken.
constexpr int kMostErrors = 64;
/// SCPI-99, 7.2.1.4 and 5: an instrument's words for infinity and not-a-number.
constexpr double kInfinity = 9.9e37;

/// Stands for the value in a description's `set`.
constexpr std::string_view kPlace = "{value}";
/// What a number is rounded to on its way.
constexpr double kSentResolution = 1e-6;

/// Lost or garbled on the way, as against refused: the outcome is unknown.
bool is_lost(const Error& error) {
  return error.code == ErrorCode::kTimeout || error.code == ErrorCode::kProtocol;
}

bool is_self_test(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text.find("*TST") != std::string::npos;
}

}  // namespace

std::optional<double> parse_scpi_number(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(std::abs(value) < kInfinity)) return std::nullopt;
  return value;
}

ScpiDialogue::ScpiDialogue(std::string name, const config::ScpiDevice& device,
                           std::unique_ptr<MessageTransport> transport, Clock& clock)
    : name_(std::move(name)),
      expected_identity_(device.identity),
      initialise_(device.initialise),
      set_(device.set),
      set_query_(device.set_query),
      scale_(device.scale),
      set_tolerance_(std::max(device.resolution, kSentResolution * std::abs(device.scale))),
      error_query_(device.error_query),
      busy_errors_(device.busy_errors),
      transport_(std::move(transport)),
      clock_(clock) {}

Error ScpiDialogue::error(ErrorCode code, const std::string& message) const {
  return {code, name_ + ": " + message};
}

Result<ScpiDialogue> ScpiDialogue::attach(std::string name, const config::ScpiDevice& device,
                                          std::unique_ptr<MessageTransport> transport,
                                          Clock& clock) {
  ScpiDialogue dialogue(std::move(name), device, std::move(transport), clock);
  std::vector<std::string> all = device.initialise;
  for (const auto* text : {&device.set, &device.set_query, &device.measure_query, &device.output_on,
                           &device.output_off, &device.error_query}) {
    all.push_back(*text);
  }
  if (const auto test = std::find_if(all.begin(), all.end(), is_self_test); test != all.end()) {
    return dialogue.error(ErrorCode::kBadInput,
                          fmt::format("{} would send {}: the self test swings the output to its "
                                      "maximum and is never sent",
                                      device.name, *test));
  }
  if (!device.set.empty() && device.set.find(kPlace) == std::string::npos) {
    return dialogue.error(ErrorCode::kBadInput,
                          fmt::format("\"{}\" has no {} in it", device.set, kPlace));
  }
  return dialogue;
}

Result<ScpiDialogue> ScpiDialogue::open(std::string name, const config::ScpiDevice& device,
                                        std::unique_ptr<MessageTransport> transport, Clock& clock) {
  auto dialogue = attach(std::move(name), device, std::move(transport), clock);
  if (!dialogue) return dialogue;
  if (const Status begun = dialogue->begin(); !begun) return begun.error();
  return dialogue;
}

Status ScpiDialogue::begin() {
  lost_ = false;  // what follows asks and commands
  Status begun = begin_anew();
  if (!begun) lost_ = true;
  return begun;
}

Status ScpiDialogue::begin_anew() {
  if (const Status cleared = transport_->clear(); !cleared) return failed("clear", cleared.error());
  auto identity = query("*IDN?");
  if (!identity) return identity.error();
  if (identity->find(expected_identity_) == std::string::npos) {
    return error(ErrorCode::kDevice, fmt::format("says that it is {}, expected {}",
                                                 one_line(*identity), expected_identity_));
  }
  identity_ = one_line(*identity);
  if (const auto old = drain_errors(&ScpiDialogue::query); !old) return old.error();
  for (const std::string& text : initialise_) {
    if (Status done = command(text); !done) return done;
  }
  return {};
}

Status ScpiDialogue::resume() {
  return lost_ ? begin() : Status{};
}

Status ScpiDialogue::tell(const std::string& text) {
  told_ = true;
  const Status sent = transport_->write(text);
  return sent ? sent : failed(text, sent.error());
}

Status ScpiDialogue::tell_value(double value) {
  return tell(set_text(value));
}

Result<double> ScpiDialogue::look(const std::string& question) {
  const auto answer = ask(question);
  if (!answer) {
    std::ignore = transport_->clear();
    return failed(question, answer.error());
  }
  const auto value = parse_scpi_number(*answer);
  if (value) return *value * scale_;
  return no_number(question, *answer);
}

std::string ScpiDialogue::refused() {
  if (lost_ || !std::exchange(told_, false)) return {};
  auto entries = drain_errors(&ScpiDialogue::ask);
  return entries ? std::move(entries->text) : std::string();
}

void ScpiDialogue::tell_last(double value) noexcept {
  transport_->write_last(set_text(value));
}

Error ScpiDialogue::failed(const std::string& what, const Error& failure) {
  if (failure.code == ErrorCode::kUnplugged) lost_ = true;
  return error(failure.code, fmt::format("{}: {}", what, failure.message));
}

Result<std::string> ScpiDialogue::ask(const std::string& question) {
  if (const Status sent = transport_->write(question); !sent) return sent.error();
  return transport_->read(kAnswerTimeout);
}

Result<std::string> ScpiDialogue::query(const std::string& question) {
  if (const Status resumed = resume(); !resumed) return resumed.error();
  Error failure{ErrorCode::kTimeout, ""};
  std::string queue;
  for (int attempt = 0; attempt < kQuestions; ++attempt) {
    auto answer = ask(question);
    if (answer) return answer;
    failure = answer.error();
    if (!is_lost(failure)) break;
    // Nothing half-said may be left on either side before the question is put again.
    if (const Status cleared = transport_->clear(); !cleared) break;
    // Nor an entry about this question that the next command would be blamed for.
    if (question == error_query_) continue;
    const auto entries = drain_errors(&ScpiDialogue::ask);
    if (entries && !entries->text.empty()) queue += fmt::format(" ({})", entries->text);
  }
  failure.message += queue;
  return failed(question, failure);
}

Result<double> ScpiDialogue::query_value(const std::string& question) {
  std::string says;
  for (int attempt = 0; attempt < kQuestions; ++attempt) {
    const auto answer = query(question);
    if (!answer) return answer.error();
    const auto value = parse_scpi_number(*answer);
    if (value) return *value * scale_;
    says = *answer;
  }
  return no_number(question, says);
}

Error ScpiDialogue::no_number(const std::string& question, const std::string& answer) const {
  return error(ErrorCode::kProtocol,
               fmt::format("{} answers \"{}\", expected a number", question, one_line(answer)));
}

Status ScpiDialogue::command(const std::string& text) {
  return ask_while_busy(Patience(clock_, Patience::kForCommand),
                        [&] { return command_once(text); });
}

Status ScpiDialogue::command_once(const std::string& text) {
  if (Status resumed = resume(); !resumed) return resumed;
  std::ignore = refused();
  if (const Status sent = transport_->write(text); !sent) return failed(text, sent.error());
  const auto errors = drain_errors(&ScpiDialogue::query);
  if (!errors) return errors.error();
  if (errors->text.empty()) return {};
  return error(errors->is_busy ? ErrorCode::kBusy : ErrorCode::kDevice,
               fmt::format("{} was refused: {}", text, errors->text));
}

std::string ScpiDialogue::set_text(double value) const {
  std::string text = set_;
  // Micro-units; never an exponent, which some firmware does not read.
  return text.replace(text.find(kPlace), kPlace.size(), fmt::format("{:.6f}", value / scale_));
}

Status ScpiDialogue::set(double value) {
  const std::string text = set_text(value);
  Status done = command(text);
  if (done || !is_lost(done.error()) || set_query_.empty()) return done;
  if (const Status cleared = transport_->clear(); !cleared) return done;
  const auto present = query_value(set_query_);
  if (!present) return done;
  return std::abs(*present - value) <= set_tolerance_ ? Status{} : command(text);
}

Result<ScpiDialogue::ErrorQueue> ScpiDialogue::drain_errors(
    Result<std::string> (ScpiDialogue::*put)(const std::string&)) {
  ErrorQueue all{.text = {}, .is_busy = true};
  for (int i = 0; i < kMostErrors; ++i) {
    const auto entry = (this->*put)(error_query_);
    if (!entry) return entry.error();
    const auto code = parse_scpi_number(std::string_view(*entry).substr(0, entry->find(',')));
    if (!code) {
      return error(ErrorCode::kProtocol,
                   fmt::format("{} answers \"{}\", expected a number and text", error_query_,
                               one_line(*entry)));
    }
    if (*code == 0) return all;
    all.text += (all.text.empty() ? "" : "; ") + one_line(*entry);
    all.is_busy = all.is_busy &&
                  std::find(busy_errors_.begin(), busy_errors_.end(), *code) != busy_errors_.end();
  }
  return error(ErrorCode::kProtocol,
               fmt::format("its error queue does not end after {} entries: {}", kMostErrors,
                           one_line(all.text)));
}

}  // namespace fogbench::drivers
