// The USB/IP server over loopback, met by a host that is not a kernel.

#include "simulator/wire/usbip_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/simulator/wire/loopback.hpp"

namespace fogbench::simulator {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kDeviceBytes = 312;

/// A host that has imported one device.
class Host : public Wire {
 public:
  using Wire::Wire;

  static Bytes import_request(const std::string& bus_id) {
    Bytes out{0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0};
    out.insert(out.end(), bus_id.begin(), bus_id.end());
    out.resize(40);
    return out;
  }
  /// The status of the answer.
  std::uint32_t import(const std::string& bus_id) {
    send(import_request(bus_id));
    const Bytes answer = receive(8);
    if (answer.size() != 8) return 99;
    const std::uint32_t status = be32_at(answer, 4);
    if (status == 0) {
      EXPECT_EQ(receive(kDeviceBytes).size(), kDeviceBytes);
    }
    return status;
  }

  static Bytes submit(std::uint32_t sequence, bool in, std::uint32_t endpoint, std::uint32_t length,
                      const Bytes& setup = Bytes(8), const Bytes& data = {}) {
    Bytes out;
    for (const std::uint32_t word :
         {1U, sequence, 0x10002U, in ? 1U : 0U, endpoint, 0U, length, 0U, 0U, 0U}) {
      append_be32(out, word);
    }
    append(out, setup);
    append(out, data);
    return out;
  }
  static Bytes unlink(std::uint32_t sequence, std::uint32_t unlinked) {
    Bytes out;
    for (const std::uint32_t word : {2U, sequence, 0x10002U, 0U, 0U, unlinked}) {
      append_be32(out, word);
    }
    out.resize(kUsbipHeaderBytes);
    return out;
  }

  struct Answer {
    std::uint32_t code = 0, sequence = 0;
    std::int32_t status = 0;
    std::uint32_t actual = 0;
    Bytes data;
  };
  /// `in`: the transfer that it ends brings data.
  Answer answer(bool in, int ms = 5000) {
    const Bytes header = receive(kUsbipHeaderBytes, ms);
    if (header.size() != kUsbipHeaderBytes) return {};
    Answer out{be32_at(header, 0),
               be32_at(header, 4),
               static_cast<std::int32_t>(be32_at(header, 20)),
               be32_at(header, 24),
               {}};
    if (in && out.code == 3) out.data = receive(out.actual);
    return out;
  }
  Bytes get_descriptor(std::uint8_t type, std::uint8_t length) {
    send(submit(++sequence_, true, 0, length, {0x80, 6, 0, type, 0, 0, length, 0}));
    const Answer got = answer(true);
    EXPECT_EQ(got.sequence, sequence_);
    EXPECT_EQ(got.status, 0);
    return got.data;
  }
  /// One USBTMC query.
  std::string ask(const std::string& question) {
    Bytes out{1, 1, 0xFE, 0};
    append_le32(out, static_cast<std::uint32_t>(question.size()));
    append_le32(out, 1);
    out.insert(out.end(), question.begin(), question.end());
    out.resize((out.size() + 3) / 4 * 4);
    const auto size = [](const Bytes& bytes) { return static_cast<std::uint32_t>(bytes.size()); };
    send(submit(++sequence_, false, 1, size(out), Bytes(8), out));
    EXPECT_EQ(answer(false).actual, out.size());
    const Bytes request{2, 2, 0xFD, 0, 0, 2, 0, 0, 0, 0, 0, 0};
    send(submit(++sequence_, false, 1, size(request), Bytes(8), request));
    EXPECT_EQ(answer(false).actual, request.size());
    send(submit(++sequence_, true, 2, 512));
    const Answer got = answer(true);
    if (got.data.size() < 12) return "none";
    return {got.data.begin() + 12,
            got.data.begin() + 12 + static_cast<std::ptrdiff_t>(le32_at(got.data, 4))};
  }

 private:
  std::uint32_t sequence_ = 100;
};

class UsbipServerTest : public ServedBenchTest {
 protected:
  using ServedBenchTest::ServedBenchTest;
  Host host() const { return Host(bench_->usbip_port()); }
  std::uint32_t listed() const {
    Host lister = host();
    lister.send(Bytes{0x01, 0x11, 0x80, 0x05, 0, 0, 0, 0});
    const Bytes head = lister.receive(12);
    if (head.size() != 12) return 99;
    const std::uint32_t count = be32_at(head, 8);
    EXPECT_EQ(lister.receive(count * (kDeviceBytes + 4)).size(), count * (kDeviceBytes + 4));
    EXPECT_TRUE(lister.closed());
    return count;
  }
};

TEST_F(UsbipServerTest, ListsWhatNobodyHasImported) {
  EXPECT_EQ(listed(), 3U);
  Host one = host();
  EXPECT_EQ(one.import("1-2"), 0U);
  EXPECT_EQ(listed(), 2U);
}

TEST_F(UsbipServerTest, ADeviceIsImportedOnceAndByItsName) {
  Host first = host();
  EXPECT_EQ(first.import("1-1"), 0U);
  Host second = host();
  EXPECT_EQ(second.import("1-1"), 2U) << "busy";
  EXPECT_TRUE(second.closed());
  EXPECT_EQ(host().import("1-9"), 4U) << "no such device";
  EXPECT_EQ(host().import(""), 4U);
}

TEST_F(UsbipServerTest, ADeviceIsFreeAgainWhenItsHostGoes) {
  {
    Host first = host();
    EXPECT_EQ(first.import("1-1"), 0U);
  }
  for (int i = 0; listed() != 3U && i < 100; ++i) {
  }
  EXPECT_EQ(host().import("1-1"), 0U);
}

TEST_F(UsbipServerTest, CarriesControlBulkAndInterruptTransfers) {
  Host supply = host();
  ASSERT_EQ(supply.import("1-1"), 0U);
  EXPECT_EQ(supply.get_descriptor(1, 18).size(), 18U);
  EXPECT_EQ(supply.ask("*IDN?"), "KEPCO,BOP 36-6\n");
  EXPECT_EQ(supply.ask("CURR 0.5;CURR?"), "5.000000E-01\n");

  Host magnetometer = host();
  ASSERT_EQ(magnetometer.import("1-3"), 0U);
  magnetometer.send(Host::submit(1, true, 1, 64));
  magnetometer.send(Host::submit(2, true, 1, 64));
  for (const std::uint32_t sequence : {1U, 2U}) {
    const Host::Answer report = magnetometer.answer(true);
    EXPECT_EQ(report.sequence, sequence);
    ASSERT_EQ(report.data.size(), 16U);
    EXPECT_EQ(report.data[0], 7);
  }
}

TEST_F(UsbipServerTest, AnUnsupportedRequestStalls) {
  Host supply = host();
  ASSERT_EQ(supply.import("1-1"), 0U);
  supply.send(Host::submit(5, true, 0, 8, {0xC0, 0x77, 0, 0, 0, 0, 8, 0}));
  const Host::Answer answer = supply.answer(true);
  EXPECT_EQ(answer.status, -32);
  EXPECT_TRUE(answer.data.empty());
}

TEST_F(UsbipServerTest, ATransferUnderWayIsTakenBack) {
  Host supply = host();
  ASSERT_EQ(supply.import("1-1"), 0U);
  supply.send(Host::submit(7, true, 2, 512));  // Nothing was asked for.
  EXPECT_EQ(supply.answer(true, 100).code, 0U);
  supply.send(Host::unlink(8, 7));
  Host::Answer answer = supply.answer(false);
  EXPECT_EQ(answer.code, 4U);
  EXPECT_EQ(answer.sequence, 8U);
  EXPECT_EQ(answer.status, -104);
  supply.send(Host::unlink(9, 7));
  answer = supply.answer(false);
  EXPECT_EQ(answer.status, 0) << "it has ended";
  EXPECT_EQ(supply.ask("*IDN?"), "KEPCO,BOP 36-6\n");
}

TEST_F(UsbipServerTest, ClosesOnWhatNoHostSends) {
  Host http = host();
  http.send(Bytes{'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P'});
  EXPECT_TRUE(http.closed());
  Host oversized = host();
  ASSERT_EQ(oversized.import("1-1"), 0U);
  oversized.send(Host::submit(1, false, 1, 0x7FFFFFFF));
  EXPECT_TRUE(oversized.closed());
  EXPECT_EQ(host().import("1-1"), 0U);
}

TEST_F(UsbipServerTest, HalfAMessageHoldsUpNobody) {
  Host half = host();
  half.send(Bytes{0x01, 0x11, 0x80});
  Host half_submit = host();
  ASSERT_EQ(half_submit.import("1-2"), 0U);
  half_submit.send(Host::submit(1, false, 1, 1000));
  Host whole = host();
  ASSERT_EQ(whole.import("1-1"), 0U);
  EXPECT_EQ(whole.ask("*IDN?"), "KEPCO,BOP 36-6\n");
  half.send(Bytes{0x05, 0, 0, 0, 0});
  EXPECT_EQ(be32_at(half.receive(12), 8), 1U);
}

TEST_F(UsbipServerTest, ByteByByteIsAsGood) {
  Host slow = host();
  for (const std::uint8_t byte : Host::import_request("1-1")) slow.send(Bytes{byte});
  EXPECT_EQ(slow.receive(8 + kDeviceBytes).size(), 8 + kDeviceBytes);
  for (const std::uint8_t byte : Host::submit(3, true, 0, 18, {0x80, 6, 0, 1, 0, 0, 18, 0})) {
    slow.send(Bytes{byte});
  }
  EXPECT_EQ(slow.answer(true).data.size(), 18U);
}

TEST_F(UsbipServerTest, MoreConnectionsThanItKeepsAreClosed) {
  std::vector<Host> idle;
  for (std::size_t i = 0; i < UsbipServer::kMostConnections; ++i) {
    idle.push_back(host());
    ASSERT_TRUE(idle.back().connected());
  }
  idle.front().send(Bytes{0x01});  // It lives.
  EXPECT_TRUE(host().closed());
  idle.clear();
  for (int i = 0; listed() == 99U && i < 100; ++i) {
  }
  EXPECT_EQ(listed(), 3U);
}

TEST_F(UsbipServerTest, AHostThatNeverReadsIsNotReadEither) {
  Host deaf = host();
  ASSERT_EQ(deaf.import("1-1"), 0U);
  const Bytes ask = Host::submit(1, true, 0, 255, {0x80, 6, 0, 2, 0, 0, 255, 0});
  std::size_t sent = 0;
  for (;;) {  // Until nothing more goes into the line for a while.
    pollfd ready{deaf.descriptor(), POLLOUT, 0};
    if (poll(&ready, 1, 300) <= 0) break;
    const ssize_t count =
        ::send(deaf.descriptor(), ask.data(), ask.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) sent += static_cast<std::size_t>(count);
    ASSERT_LT(sent, 64U << 20U) << "the bench takes without end";
  }
  EXPECT_EQ(listed(), 2U) << "the others are served";
}

class UnpluggedUsbTest : public UsbipServerTest {
 protected:
  static config::ScenarioConfig scenario() {
    config::ScenarioConfig out;
    out.faults = {fault("coil_horizontal", config::FaultKind::kUnplug, 40.0, 40.0)};
    return out;
  }
  UnpluggedUsbTest() : UsbipServerTest(scenario()) {}
};

TEST_F(UnpluggedUsbTest, IsDetachedAndCanBeImportedAgain) {
  Host supply = host();
  ASSERT_EQ(supply.import("1-1"), 0U);
  clock_.jump_to(41.0);
  EXPECT_TRUE(supply.closed());
  EXPECT_EQ(listed(), 2U);
  EXPECT_EQ(host().import("1-1"), 4U);
  clock_.jump_to(81.0);
  Host again = host();
  ASSERT_EQ(again.import("1-1"), 0U);
  EXPECT_EQ(again.ask("*IDN?"), "KEPCO,BOP 36-6\n");
}

}  // namespace
}  // namespace fogbench::simulator
