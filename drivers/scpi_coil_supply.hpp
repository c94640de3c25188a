#pragma once
// One pair of coils' bipolar current source, spoken to in SCPI.

#include <memory>
#include <string>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"
#include "drivers/scpi_dialogue.hpp"

namespace fogbench::drivers {

class ScpiCoilSupply final : public CoilSupply {
 public:
  /// Says nothing yet. `name` stands in front of every message; `clock` must outlive the supply.
  /// Errors: kBadInput, as of the dialogue.
  static Result<std::unique_ptr<ScpiCoilSupply>> attach(std::string name,
                                                        const config::CoilConfig& config,
                                                        std::unique_ptr<MessageTransport> transport,
                                                        Clock& clock);

  /// Leaves it at 0 A with the output off.
  Status begin() override;
  Result<std::string> identity() override { return dialogue_.identity(); }
  Status enable() override;
  /// The current is rounded to the output's resolution first.
  Status set_current(Ampere current) override;
  /// Waits until the read-back, which is a mean, has left the last change behind.
  Result<CoilReading> read() override;
  /// Tries both whatever fails on the way; the error is the first one.
  Status switch_off() override;
  Status confirm_off() override;
  void send_last_zero() noexcept override { dialogue_.tell_last(0.0); }

 private:
  ScpiCoilSupply(ScpiDialogue dialogue, config::CoilConfig config, Clock& clock)
      : dialogue_(std::move(dialogue)),
        config_(std::move(config)),
        clock_(clock),
        valid_from_(clock.now()) {}
  Status program(double current_a);
  /// When the read-back has left the last change behind.
  void settle();
  /// kDevice when the output is not where it was set, as `measure` says.
  Status verify(double set_a, Result<double> (ScpiDialogue::*measure)(const std::string&));

  ScpiDialogue dialogue_;
  config::CoilConfig config_;
  Clock& clock_;
  Clock::Instant valid_from_;  ///< before it the read-back still has the last change in it
};

}  // namespace fogbench::drivers
