#pragma once
// Result<T>: the value, or one Error with a line that a person can act on.
// Used for whatever can fail in normal use (files, protocols, configuration, fits); no exception
// leaves a folder.

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace fogbench::config {

/// What kind of thing went wrong; the executables map it to their exit status.
enum class ErrorCode {
  kUsage,      ///< the command line is wrong (exit 2)
  kBadInput,   ///< a file, a key or a table is wrong (exit 3)
  kLimit,      ///< a request lies outside the bench's or an instrument's limits (exit 3)
  kDevice,     ///< an instrument refused or reported an error (exit 4)
  kBusy,       ///< an instrument asks to be asked again later (exit 4)
  kHeld,       ///< an instrument or a run log belongs to another process (exit 4)
  kUnplugged,  ///< an instrument is gone from where it was connected (exit 4)
  kTimeout,    ///< an instrument did not answer, or a quantity did not settle, in time (exit 4)
  kStale,      ///< a reading is older than it may be, or was repeated (exit 4)
  kProtocol,   ///< an instrument's answer makes no sense (exit 4)
  kStore,      ///< the run log cannot be written or read (exit 4)
  kAborted,    ///< the operator or a signal ended the run (exit 4)
};

/// One line: where (file and line, or JSON pointer, or instrument), what was found, what was
/// expected.
struct Error {
  ErrorCode code;
  std::string message;
};

inline Error bad_input(std::string message) {
  return Error{ErrorCode::kBadInput, std::move(message)};
}

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  /// Precondition: holds an error.
  const Error& error() const { return std::get<1>(state_); }

 private:
  T& value() { return std::get<0>(state_); }
  const T& value() const { return std::get<0>(state_); }
  std::variant<T, Error> state_;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit

  explicit operator bool() const { return !error_.has_value(); }
  /// Precondition: holds an error.
  const Error& error() const {
    assert(error_.has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace fogbench::config

namespace fogbench {
using config::Error;
using config::ErrorCode;
using config::Result;
using config::Status;
}  // namespace fogbench
