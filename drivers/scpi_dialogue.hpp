#pragma once
// What all SCPI instruments have in common: questions, commands, and the error queue, which is
// emptied after every command so that a refusal is never found later under another command's name.
//
// The self test (*TST?) is never sent: it swings a supply's output to its maximum, and that
// magnetises the gyro's shield.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/device.hpp"
#include "drivers/clock.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

/// A number as SCPI writes it ("+1.5", " -1.112E+00"); none when anything else is there, or one of
/// its words for infinity and not-a-number.
std::optional<double> parse_scpi_number(std::string_view text);

class ScpiDialogue {
 public:
  /// Says nothing yet. `name` stands in front of every message; `clock` must outlive the dialogue.
  /// Errors: kBadInput for a description
  /// that would send a self test, or whose `set` has no place for the value; one without a `set`
  /// sets nothing.
  static Result<ScpiDialogue> attach(std::string name, const config::ScpiDevice& device,
                                     std::unique_ptr<MessageTransport> transport, Clock& clock);
  /// Attached and begun.
  static Result<ScpiDialogue> open(std::string name, const config::ScpiDevice& device,
                                   std::unique_ptr<MessageTransport> transport, Clock& clock);

  /// Clears the line, checks the identity, empties the queue of old errors and sends the
  /// initialisation. Errors: kDevice for another instrument than described; else as below.
  Status begin();

  const std::string& name() const { return name_; }
  const std::string& identity() const { return identity_; }

  // Whoever is there, in whatever state: for what must be done first and judged later.

  /// Sends it, and waits for nothing.
  Status tell(const std::string& text);
  Status tell_value(double value);
  /// Asks once. What a failed question leaves under way is cleared.
  Result<double> look(const std::string& question);
  /// What it has refused of what it was told, as far as that can be known: of a dialogue that has
  /// not begun nobody knows what was in the queue before.
  std::string refused();
  /// As MessageTransport::write_last().
  void tell_last(double value) noexcept;

  // An instrument that was unplugged may have forgotten what it was told: the first of these that
  // reaches it again begins the dialogue anew, with its identity checked, before it does its own.

  /// Asks again once when no answer came, or one that is not to this question: a question changes
  /// nothing. What the failed one left in the error queue is taken out of it.
  Result<std::string> query(const std::string& question);
  /// A question for the value, in the description's unit. Asks again once when the answer is no
  /// finite number; kProtocol when it is none again.
  Result<double> query_value(const std::string& question);
  /// Sends it, then empties the error queue. kDevice with every entry that was in it; where all of
  /// them say that the instrument is busy it is sent again for as long as a command's Patience has
  /// it, then kBusy.
  Status command(const std::string& text);
  /// The description's `set` with {value} replaced, the value in the description's unit. When it
  /// was lost or its outcome unknown, what the instrument says that it was set to decides whether
  /// it is sent again, once.
  Status set(double value);

  Error error(ErrorCode code, const std::string& message) const;

 private:
  ScpiDialogue(std::string name, const config::ScpiDevice& device,
               std::unique_ptr<MessageTransport> transport, Clock& clock);
  /// Clear, identity, old errors, initialisation.
  Status begin_anew();
  /// The description's `set` with the value in it.
  std::string set_text(double value) const;
  Error no_number(const std::string& question, const std::string& answer) const;
  /// Begins anew after the instrument was gone.
  Status resume();
  /// The error as the dialogue's; takes note when the instrument is gone.
  Error failed(const std::string& what, const Error& error);
  /// One question, one answer.
  Result<std::string> ask(const std::string& question);
  Status command_once(const std::string& text);
  struct ErrorQueue {
    std::string text;      ///< all entries, joined; empty when there were none
    bool is_busy = false;  ///< and nothing else is the matter
  };
  /// Takes everything out of it. `put` is how the question is put.
  Result<ErrorQueue> drain_errors(Result<std::string> (ScpiDialogue::*put)(const std::string&));

  std::string name_;
  std::string expected_identity_;
  std::vector<std::string> initialise_;
  std::string identity_;
  std::string set_;
  std::string set_query_;
  double scale_;          ///< value of one on the wire
  double set_tolerance_;  ///< within it two values are one setting
  std::string error_query_;
  std::vector<int> busy_errors_;
  std::unique_ptr<MessageTransport> transport_;
  Clock& clock_;
  bool lost_ = true;   ///< it may not know what begin() tells it
  bool told_ = false;  ///< the queue may hold errors about what it was told past all checks
};

}  // namespace fogbench::drivers
