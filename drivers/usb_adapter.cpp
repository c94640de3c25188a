#include "drivers/usb_adapter.hpp"

#include <fmt/format.h>

#include <fstream>

namespace fogbench::drivers {
namespace {

std::string first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

std::string usb_adapter_of(const std::filesystem::path& tty, const std::filesystem::path& sys) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path name = fs::canonical(tty, error).filename();
  fs::path folder = fs::canonical(sys / "class/tty" / name / "device", error);
  if (error) return {};
  // The line's folder lies in the interface's, that in the device's, which has the numbers.
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    const std::string vendor = first_line(folder / "idVendor");
    if (vendor.empty()) continue;
    const std::string serial = first_line(folder / "serial");
    return fmt::format("{}:{} {} {}", vendor, first_line(folder / "idProduct"),
                       serial.empty() ? "at" : "serial",
                       serial.empty() ? folder.filename().string() : serial);
  }
  return {};
}

}  // namespace fogbench::drivers
