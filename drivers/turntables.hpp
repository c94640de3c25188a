#pragma once
// The turntable: motorised, spoken to in SCPI, or the operator's hand.

#include <functional>
#include <memory>
#include <string>

#include "config/bench.hpp"
#include "drivers/instruments.hpp"
#include "drivers/scpi_dialogue.hpp"

namespace fogbench::drivers {

class ScpiTurntable final : public Turntable {
 public:
  /// `name` stands in front of every message; `clock` must outlive the turntable.
  /// Errors: kBadInput when the description is missing, or as of the dialogue's attach.
  static Result<std::unique_ptr<ScpiTurntable>> attach(std::string name,
                                                       const config::TurntableConfig& config,
                                                       std::unique_ptr<MessageTransport> transport,
                                                       Clock& clock);

  Status begin() override { return dialogue_.begin(); }
  Result<std::string> identity() override { return dialogue_.identity(); }
  /// The azimuth is rounded to the motor's resolution first. kTimeout when it is not there after
  /// three times the usual time of a move.
  Status rotate_to(Degree azimuth) override;
  Result<Degree> azimuth() override;

 private:
  ScpiTurntable(ScpiDialogue dialogue, const config::TurntableConfig& config, Clock& clock)
      : dialogue_(std::move(dialogue)),
        device_(*config.device),
        move_time_(from_seconds(config.move_time.count())),
        clock_(clock) {}

  ScpiDialogue dialogue_;
  config::ScpiDevice device_;
  Clock::Duration move_time_;
  Clock& clock_;
};

class ManualTurntable final : public Turntable {
 public:
  /// The gyro is mounted at azimuth 0. `asked` must outlive the turntable; `turned`, if any, is
  /// told of every turn that he has made.
  ManualTurntable(std::string name, Operator& asked, std::function<void(double)> turned = {})
      : name_(std::move(name)), operator_(asked), turned_(std::move(turned)) {}

  Result<std::string> identity() override { return std::string("turned by the operator"); }
  /// Asks for it and believes the answer; kAborted when the operator declines. Asks for nothing
  /// when the gyro stands there already.
  Status rotate_to(Degree azimuth) override;
  Result<Degree> azimuth() override { return azimuth_; }

 private:
  std::string name_;
  Operator& operator_;
  std::function<void(double)> turned_;
  Degree azimuth_{0.0};
};

}  // namespace fogbench::drivers
