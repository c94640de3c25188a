#include "drivers/usb_adapter.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace fogbench::drivers {
namespace {

namespace fs = std::filesystem;

/// The part of /sys that describes one adapter, and its line in /dev.
class UsbAdapterTest : public testing::Test {
 protected:
  UsbAdapterTest() {
    fs::create_directories(line_);
    fs::create_directories(folder_ / "sys/class/tty/ttyUSB0");
    fs::create_symlink(line_, folder_ / "sys/class/tty/ttyUSB0/device");
    folder_.file("ttyUSB0", "");
    fs::create_symlink(folder_ / "ttyUSB0", folder_ / "by-id");
    write("idVendor", "0403");
    write("idProduct", "6001");
  }
  void write(const char* name, const std::string& text) const {
    std::ofstream(device_ / name) << text << "\n";
  }
  std::string adapter_of(const char* tty) const {
    return usb_adapter_of(folder_ / tty, folder_ / "sys");
  }

  support::TemporaryFolder folder_;
  fs::path device_ = folder_ / "sys/devices/pci0000:00/usb1/1-2/1-2.3";
  fs::path line_ = device_ / "1-2.3:1.0/ttyUSB0";
};

TEST_F(UsbAdapterTest, IsKnownByItsSerialNumberWhateverTheLineIsCalled) {
  write("serial", "A600XYZ");
  EXPECT_EQ(adapter_of("ttyUSB0"), "0403:6001 serial A600XYZ");
  EXPECT_EQ(adapter_of("by-id"), "0403:6001 serial A600XYZ");
}

TEST_F(UsbAdapterTest, WithoutASerialNumberItIsKnownByItsPlace) {
  EXPECT_EQ(adapter_of("ttyUSB0"), "0403:6001 at 1-2.3");
}

TEST_F(UsbAdapterTest, ALineThatIsOnNoUsbHasNone) {
  fs::remove(device_ / "idVendor");
  EXPECT_EQ(adapter_of("ttyUSB0"), "");
  EXPECT_EQ(adapter_of("ttyS9"), "");
  EXPECT_EQ(usb_adapter_of("/dev/null"), "");
}

}  // namespace
}  // namespace fogbench::drivers
