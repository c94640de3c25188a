#pragma once
// A serial line that no other program has open at the same time: two readers would each get half of
// a stream, and a second program's settings would change the first one's rate.

#include <memory>
#include <string>

#include "config/result.hpp"
#include "drivers/file_descriptor.hpp"
#include "drivers/process_lock.hpp"

namespace fogbench::drivers {

/// For as long as a port lives, whether its line is plugged in or not. A name in /dev/serial/by-id
/// is a link: both it and the device that it stands for now are locked. Errors: kHeld, kDevice.
Result<InstrumentLock> lock_serial_line(const std::string& tty);

/// Opens the line and takes it from programs that know nothing of our locks, by flock, as most
/// terminal programs ask for it; nothing of the line has been changed then. Errors: kUnplugged when
/// it is not there or no serial line; kHeld.
Result<std::unique_ptr<FileDescriptor>> open_exclusively(const std::string& tty);

/// From now on no other program can open the line, until it is closed (TIOCEXCL). A pseudo-terminal
/// is left out: it would stay shut for as long as its other side is open, even after a crash.
void shut_others_out(int fd);

}  // namespace fogbench::drivers
