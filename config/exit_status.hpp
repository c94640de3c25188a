#pragma once
// What the executables' exit status says; scripts rely on it.

#include "config/result.hpp"

namespace fogbench::config {

enum class ExitStatus {
  kDone = 0,
  kNo = 1,        ///< the answer is no: limits failed, model inadequate
  kUsage = 2,     ///< the command line is wrong
  kBadInput = 3,  ///< a file, a key or a table is wrong
  kFailed = 4     ///< the bench, the daemon or the run log failed
};

constexpr ExitStatus exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage:
      return ExitStatus::kUsage;
    case ErrorCode::kBadInput:
    case ErrorCode::kLimit:
      return ExitStatus::kBadInput;
    case ErrorCode::kDevice:
    case ErrorCode::kBusy:
    case ErrorCode::kHeld:
    case ErrorCode::kUnplugged:
    case ErrorCode::kTimeout:
    case ErrorCode::kStale:
    case ErrorCode::kProtocol:
    case ErrorCode::kStore:
    case ErrorCode::kAborted:
      return ExitStatus::kFailed;
  }
  return ExitStatus::kFailed;
}

}  // namespace fogbench::config

namespace fogbench {
using config::ExitStatus;
}  // namespace fogbench
