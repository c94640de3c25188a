#pragma once
// The queue, kept in a file beside the run log so that it outlives the daemon: a night's runs are
// not forgotten by a power cut. What it holds is planned anew, and held, at the next start.
//
// It belongs to the one daemon that serves the run log: nobody else reads, writes or removes it.

#include <filesystem>
#include <memory>
#include <utility>

#include "config/result.hpp"
#include "daemon/run_desk.hpp"
#include "drivers/process_lock.hpp"

namespace fogbench::daemon {

class QueueFile {
 public:
  /// Makes this process the one that serves the run log, until it ends (fogbench.db.serving).
  /// Errors: kHeld, which names the process that is; kDevice.
  static Result<QueueFile> open(const std::filesystem::path& store);

  /// Puts what is in the file into the desk's queue, which is held then. What can no longer be
  /// planned is left out, with its reason in the log. kBadInput when the file is none of ours.
  Status load(RunDesk& desk, const Setup& setup, const std::filesystem::path& store);

  /// Writes when the queue has changed since the last time; no file: there never was a job. A
  /// failure is
  /// in the log once, and tried again.
  void update(const RunDesk& desk);

 private:
  QueueFile(std::filesystem::path path, std::unique_ptr<drivers::ProcessLock> serving)
      : path_(std::move(path)), serving_(std::move(serving)) {}
  Status write(const JobQueue::Waiting& waiting) const;

  std::filesystem::path path_;
  std::unique_ptr<drivers::ProcessLock> serving_;
  std::uint64_t written_ = 0;
  bool failing_ = false;
};

}  // namespace fogbench::daemon
