#include "simulator/wire/usb_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "simulator/far_ends.hpp"
#include "simulator/wire/hid_device.hpp"
#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using State = UsbTransfer::State;

class HidUsbDeviceTest : public testing::Test {
 protected:
  HidUsbDeviceTest()
      : ends_(*make_far_ends(test_bench(), {}, 1, clock_)),
        device_({.vendor_id = 0x1209,
                 .product_id = 0x0001,
                 .manufacturer = "us",
                 .product = "magnetometer",
                 .serial = "SIM-MAG-1"},
                test_magnetometer(), *ends_.magnetometer, clock_) {}

  UsbTransfer control(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                      std::uint16_t index = 0, std::uint16_t length = 255) {
    return device_.control({type, request, value, index, length}, {});
  }

  drivers::VirtualClock machine_;
  DeferringClock clock_{machine_};
  FarEnds ends_;
  HidUsbDevice device_;
};

TEST_F(HidUsbDeviceTest, GivesItsDeviceDescriptor) {
  EXPECT_THAT(control(0x80, 6, 0x0100).data,
              ElementsAre(18, 1, 0, 2, 0, 0, 0, 64, 0x09, 0x12, 0x01, 0, 0, 1, 1, 2, 3, 1));
  EXPECT_EQ(control(0x80, 6, 0x0100, 0, 8).data.size(), 8U) << "no more than asked for";
  EXPECT_THAT(control(0x80, 6, 0x0600).data, ElementsAre(10, 6, 0, 2, 0, 0, 0, 64, 1, 0));
}

TEST_F(HidUsbDeviceTest, GivesItsConfigurationWithAllThatIsInIt) {
  const Bytes all = control(0x80, 6, 0x0200).data;
  ASSERT_EQ(all.size(), 9U + 9U + 9U + 7U);
  EXPECT_EQ(le16_at(all, 2), all.size());
  EXPECT_THAT(Bytes(all.begin() + 9, all.begin() + 18), ElementsAre(9, 4, 0, 0, 1, 3, 0, 0, 0));
  EXPECT_EQ(all[18 + 1], 0x21) << "HID";
  EXPECT_EQ(le16_at(all, 18 + 7), hid_report_descriptor(test_magnetometer()).size());
  // 100 ms is asked for every 2^(10 - 1) microframes, 64 ms.
  EXPECT_THAT(Bytes(all.begin() + 27, all.end()), ElementsAre(7, 5, 0x81, 3, 16, 0, 10));
}

TEST_F(HidUsbDeviceTest, GivesItsStrings) {
  EXPECT_THAT(control(0x80, 6, 0x0300).data, ElementsAre(4, 3, 0x09, 0x04));
  EXPECT_THAT(control(0x80, 6, 0x0301).data, ElementsAre(6, 3, 'u', 0, 's', 0));
  const Bytes serial = control(0x80, 6, 0x0303).data;
  EXPECT_EQ(serial.size(), 2U + 2U * 9U);
  EXPECT_EQ(serial[2], 'S');
  EXPECT_EQ(control(0x80, 6, 0x0304).state, State::kStall);
}

TEST_F(HidUsbDeviceTest, KnowsTheStandardRequests) {
  EXPECT_THAT(control(0x80, 8, 0).data, ElementsAre(0)) << "not configured";
  EXPECT_EQ(control(0x00, 9, 1).state, State::kDone);
  EXPECT_THAT(control(0x80, 8, 0).data, ElementsAre(1));
  EXPECT_EQ(control(0x00, 9, 2).state, State::kStall) << "there is one configuration";
  EXPECT_THAT(control(0x80, 0, 0).data, ElementsAre(1, 0)) << "feeds itself";
  EXPECT_THAT(control(0x81, 0, 0).data, ElementsAre(0, 0));
  EXPECT_THAT(control(0x81, 10, 0).data, ElementsAre(0));
  EXPECT_EQ(control(0x01, 11, 0).state, State::kDone);
  EXPECT_EQ(control(0x01, 11, 1).state, State::kStall) << "there is one setting";
  EXPECT_EQ(control(0x81, 0, 0, 1).state, State::kStall) << "there is one interface";
  EXPECT_EQ(control(0x80, 6, 0x0F00).state, State::kStall) << "no BOS in USB 2.0";
  EXPECT_EQ(control(0xC0, 1, 0).state, State::kStall) << "a vendor's";
}

TEST_F(HidUsbDeviceTest, AnEndpointIsHaltedAndCleared) {
  machine_.sleep_for(1s);
  EXPECT_EQ(control(0x02, 3, 0, 0x81).state, State::kDone);
  EXPECT_THAT(control(0x82, 0, 0, 0x81).data, ElementsAre(1, 0));
  EXPECT_EQ(device_.in(1, 64).state, State::kStall);
  EXPECT_EQ(control(0x02, 1, 0, 0x81).state, State::kDone);
  EXPECT_THAT(control(0x82, 0, 0, 0x81).data, ElementsAre(0, 0));
  EXPECT_EQ(device_.in(1, 64).state, State::kDone);
  EXPECT_EQ(control(0x02, 1, 0, 0x83).state, State::kStall) << "no such endpoint";
  EXPECT_EQ(device_.in(3, 64).state, State::kStall);
  EXPECT_EQ(device_.out(1, Bytes{1}).state, State::kStall);
}

TEST_F(HidUsbDeviceTest, TheReportDescriptorCoversTheWholeReport) {
  // 1 byte of number, 3 x 4 of field, 1 of sequence, 2 that nothing covers.
  EXPECT_THAT(hid_report_descriptor(test_magnetometer()),
              ElementsAre(0x06, 0, 0xFF, 0x09, 1, 0xA1, 1, 0x15, 0, 0x26, 0xFF, 0, 0x75, 8,  //
                          0x85, 7,                                                           //
                          0x09, 2, 0x96, 4, 0, 0x81, 2,                                      //
                          0x09, 3, 0x96, 4, 0, 0x81, 2,                                      //
                          0x09, 4, 0x96, 4, 0, 0x81, 2,                                      //
                          0x09, 5, 0x96, 1, 0, 0x81, 2,                                      //
                          0x96, 2, 0, 0x81, 3, 0xC0));
  EXPECT_EQ(control(0x81, 6, 0x2200).data, hid_report_descriptor(test_magnetometer()));
  EXPECT_EQ(control(0x81, 6, 0x2100).data.size(), 9U);
}

TEST_F(HidUsbDeviceTest, GivesAReportEachPeriod) {
  const UsbTransfer early = device_.in(1, 64);
  EXPECT_EQ(early.state, State::kBusy);
  machine_.sleep_until(early.until);
  EXPECT_NEAR(drivers::to_seconds(machine_.now().time_since_epoch()), 0.1, 1e-6);
  for (std::uint8_t number = 1; number < 30; ++number) {
    UsbTransfer transfer = device_.in(1, 64);
    while (transfer.state == State::kBusy) {
      ASSERT_GT(transfer.until, machine_.now());
      machine_.sleep_until(transfer.until);
      transfer = device_.in(1, 64);
    }
    ASSERT_EQ(transfer.data.size(), 16U);
    EXPECT_EQ(transfer.data[0], 7) << "report id";
    EXPECT_EQ(transfer.data[13], number) << "sequence";
    EXPECT_EQ(control(0xA1, 1, 0x0107).data, transfer.data) << "GET_REPORT";
  }
}

TEST_F(HidUsbDeviceTest, KnowsTheClassRequests) {
  EXPECT_EQ(control(0x21, 0x0A, 0x0500).state, State::kDone);
  EXPECT_THAT(control(0xA1, 0x02, 0).data, ElementsAre(5)) << "idle rate";
  EXPECT_EQ(device_.control({0x21, 0x09, 0x0201, 0, 2}, Bytes{1, 2}).state, State::kDone);
  EXPECT_EQ(control(0xA1, 1, 0x0301).state, State::kStall) << "no feature report";
  EXPECT_EQ(control(0xA1, 3, 0).state, State::kStall) << "no boot protocol";
}

}  // namespace
}  // namespace fogbench::simulator
