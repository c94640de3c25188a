// Modbus over TCP and over a line, the gyro's stream and the turntable's line, met by a host that
// uses none of our drivers.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "drivers/crc.hpp"
#include "simulator/wire/modbus_protocol.hpp"
#include "simulator/wire/tcp_listener.hpp"
#include "tests/simulator/wire/loopback.hpp"

namespace fogbench::simulator {
namespace {

using ::testing::ElementsAre;

/// A host's side of a serial line.
class Line {
 public:
  explicit Line(const std::filesystem::path& path)
      : descriptor_(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}

  bool opened() const { return static_cast<bool>(descriptor_); }
  void send(ByteView bytes) {
    EXPECT_EQ(write(descriptor_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  void send(const std::string& text) { send(Bytes(text.begin(), text.end())); }
  /// Exactly so many bytes; fewer when the line is silent for `ms` or hung up.
  Bytes receive(std::size_t count, int ms = 2000) {
    Bytes out(count);
    std::size_t have = 0;
    while (have < count) {
      pollfd ready{descriptor_.get(), POLLIN, 0};
      if (poll(&ready, 1, ms) <= 0) break;
      const ssize_t got = read(descriptor_.get(), out.data() + have, count - have);
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    out.resize(have);
    return out;
  }
  std::string line() {
    std::string out;
    while (out.empty() || out.back() != '\n') {
      const Bytes next = receive(1);
      if (next.empty()) break;
      out.push_back(static_cast<char>(next[0]));
    }
    return out;
  }
  /// Hung up within `ms`.
  bool hung_up(int ms = 5000) {
    Bytes some(4096);
    for (;;) {
      pollfd ready{descriptor_.get(), POLLIN, 0};
      if (poll(&ready, 1, ms) <= 0) return false;
      if ((ready.revents & POLLIN) == 0) return (ready.revents & POLLHUP) != 0;
      if (read(descriptor_.get(), some.data(), some.size()) <= 0) return true;
    }
  }

 private:
  drivers::FileDescriptor descriptor_;
};

class LinesTest : public ServedBenchTest {
 protected:
  using ServedBenchTest::ServedBenchTest;

  std::filesystem::path tty(const std::string& name) const { return folder_ / name; }

  /// The answer's content over TCP; empty when the bench is silent.
  static Bytes ask(Wire& wire, const Bytes& content, std::uint8_t unit = 1, int ms = 5000) {
    wire.send(encode_modbus_tcp(0x1234, unit, content));
    const Bytes header = wire.receive(7, ms);
    if (header.size() != 7) return {};
    EXPECT_EQ(be16_at(header, 0), 0x1234);
    return wire.receive(be16_at(header, 4) - 1U);
  }
  double now_s() const { return drivers::to_seconds(clock_.now().time_since_epoch()); }
};

const Bytes kReadTarget{3, 0, 2, 0, 1};
const Bytes kWriteTarget{6, 0, 2, 0x01, 0x90};  // 40.0 degC

TEST_F(LinesTest, ModbusTcpReadsAndWritesRegisters) {
  Wire wire(modbus_port());
  EXPECT_EQ(ask(wire, kWriteTarget), kWriteTarget);
  EXPECT_THAT(ask(wire, kReadTarget), ElementsAre(3, 2, 0x01, 0x90));
  EXPECT_THAT(ask(wire, {16, 0, 2, 0, 1, 2, 0x01, 0x2C}), ElementsAre(16, 0, 2, 0, 1));
  EXPECT_THAT(ask(wire, kReadTarget, 255), ElementsAre(3, 2, 0x01, 0x2C)) << "whoever listens";
}

TEST_F(LinesTest, ModbusTcpAnswersWithTheStandardsExceptions) {
  Wire wire(modbus_port());
  EXPECT_THAT(ask(wire, {1, 0, 0, 0, 1}), ElementsAre(0x81, 1)) << "no coils";
  EXPECT_THAT(ask(wire, {3, 0x7F, 0xFF, 0, 1}), ElementsAre(0x83, 2)) << "no such register";
  EXPECT_THAT(ask(wire, {6, 0x01, 0x00, 0, 1}), ElementsAre(0x86, 2)) << "not to be written";
  EXPECT_THAT(ask(wire, {6, 0, 2, 0x7F, 0xFF}), ElementsAre(0x86, 3)) << "beyond the limits";
  EXPECT_THAT(ask(wire, {16, 0, 2, 0, 0, 0}), ElementsAre(0x90, 3)) << "nothing";
}

TEST_F(LinesTest, ModbusTcpIsSilentForAnotherUnit) {
  Wire wire(modbus_port());
  EXPECT_TRUE(ask(wire, kReadTarget, 2, 200).empty());
  EXPECT_FALSE(ask(wire, kReadTarget).empty());
}

TEST_F(LinesTest, ModbusTcpServesSeveralAndClosesOnGarbage) {
  Wire one(modbus_port()), two(modbus_port()), half(modbus_port());
  half.send(Bytes{0, 1, 0, 0, 0, 6});
  const Bytes request = encode_modbus_tcp(7, 1, kReadTarget);
  for (int i = 0; i < 3; ++i) {  // Three requests in one breath.
    one.send(request);
    two.send(request);
  }
  EXPECT_EQ(one.receive(3 * 11).size(), 33U);
  EXPECT_EQ(two.receive(3 * 11).size(), 33U);
  Wire garbage(modbus_port());
  garbage.send(Bytes{'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P'});
  EXPECT_TRUE(garbage.closed());
  half.send(Bytes{1, 3, 0, 2, 0, 1});
  EXPECT_EQ(half.receive(11).size(), 11U);
}

TEST_F(LinesTest, TheTurntableObeysWhatAHostSaidBeforeItHungUp) {
  {
    Line last_words(tty("turntable"));
    ASSERT_TRUE(last_words.opened());
    last_words.send("POS?\n");
    EXPECT_NE(last_words.line(), "");
    last_words.send("\nPOS 12.5\nMEAS:POS?\n");
  }
  std::string setting;
  for (int i = 0; i < 50 && setting != "1.250000E+01\n"; ++i) {
    Line next(tty("turntable"));
    next.send("POS?\n");
    setting = next.line();
  }
  EXPECT_EQ(setting, "1.250000E+01\n");
}

TEST_F(LinesTest, ModbusRtuIsTheSameControllerOnALine) {
  Wire wire(modbus_port());
  EXPECT_EQ(ask(wire, kWriteTarget), kWriteTarget);
  Line line(tty("thermostat"));
  ASSERT_TRUE(line.opened());
  line.send(encode_modbus_rtu(1, kReadTarget));
  EXPECT_EQ(line.receive(7), encode_modbus_rtu(1, Bytes{3, 2, 0x01, 0x90}));
}

TEST_F(LinesTest, ModbusRtuIsSilentWhereTheStandardWantsIt) {
  Line line(tty("thermostat"));
  Bytes broken = encode_modbus_rtu(1, kReadTarget);
  broken.back() ^= 1;
  line.send(broken);
  EXPECT_TRUE(line.receive(1, 200).empty()) << "wrong check value";
  line.send(encode_modbus_rtu(2, kReadTarget));
  EXPECT_TRUE(line.receive(1, 200).empty()) << "another unit";
  line.send(encode_modbus_rtu(0, kWriteTarget));
  EXPECT_TRUE(line.receive(1, 200).empty()) << "everybody is told, nobody answers";
  line.send(encode_modbus_rtu(1, kReadTarget));
  EXPECT_EQ(line.receive(7), encode_modbus_rtu(1, Bytes{3, 2, 0x01, 0x90}));
  line.send(encode_modbus_rtu(1, Bytes{43, 14, 1, 0}));
  EXPECT_EQ(line.receive(5), encode_modbus_rtu(1, Bytes{0xAB, 1})) << "its length is not known";
}

TEST_F(LinesTest, ModbusRtuTakesAFrameInPieces) {
  Line line(tty("thermostat"));
  for (const std::uint8_t byte : encode_modbus_rtu(1, kReadTarget)) line.send(Bytes{byte});
  EXPECT_EQ(line.receive(7).size(), 7U);
}

TEST_F(LinesTest, TheTurntableTurnsOnItsLine) {
  Line line(tty("turntable"));
  line.send("*IDN?\nPOS 10.5\r\nPOS?\n");
  EXPECT_EQ(line.line(), "TURNTABLE\n");
  EXPECT_EQ(line.line(), "1.050000E+01\n");
  line.send("NONSENSE\nSYST:ERR?\n");
  EXPECT_EQ(line.line(), "-113,\"Undefined header\"\n");
}

/// Counts the frames of `bytes`, which follow on a frame's end: whole, in order, none twice.
void expect_stream(const Bytes& bytes, const config::FrameDevice& device, std::uint8_t first) {
  const drivers::Crc crc(device.crc);
  ASSERT_EQ(bytes.size() % device.frame_bytes, 0U);
  for (std::size_t at = 0; at < bytes.size(); at += device.frame_bytes, ++first) {
    ASSERT_TRUE(crc.holds(bytes.data() + at)) << at;
    ASSERT_EQ(bytes[at + device.sequence_offset_bytes], first % device.sequence_modulus) << at;
  }
}

class GyroStreamTest : public LinesTest {
 protected:
  GyroStreamTest() : LinesTest({}, fast_bench()) {}
  static config::BenchConfig fast_bench() {
    config::BenchConfig bench = numbered_bench();
    bench.gyro.device = test_gyro(1000.0);
    return bench;
  }
  static constexpr std::size_t kFrame = 36;
};

TEST_F(GyroStreamTest, ComesAtItsRateAndLosesNothing) {
  Line line(tty("gyro"));
  const Bytes bytes = line.receive(1500 * kFrame);
  EXPECT_GE(now_s(), 1.5) << "no frame before its time";
  ASSERT_EQ(bytes.size(), 1500 * kFrame);
  expect_stream(bytes, test_gyro(1000.0), bytes[29]);
}

TEST_F(GyroStreamTest, AHostThatIsSlowToReadLosesNothing) {
  Line line(tty("gyro"));
  const Bytes first = line.receive(kFrame);
  ASSERT_EQ(first.size(), kFrame);
  clock_.jump_to(10.0);  // 360 kB: more than the line holds.
  expect_stream(line.receive(9000 * kFrame), test_gyro(1000.0),
                static_cast<std::uint8_t>((first[29] + 1) % 128));
}

TEST_F(GyroStreamTest, WhoOpensTheLineHearsThePresentNotThePast) {
  // A bench that the machine stalls may be late to drop the past; one that keeps it always has it.
  bool present = false;
  for (int attempt = 1; attempt <= 5 && !present; ++attempt) {
    ASSERT_TRUE(Line(tty("gyro")).opened());
    clock_.jump_to(10.0 * attempt);
    pollfd none{-1, 0, 0};
    poll(&none, 1, 100);
    Line line(tty("gyro"));
    const double begin_s = now_s();
    const Bytes bytes = line.receive(200 * kFrame);
    present = now_s() - begin_s > 0.15;
    ASSERT_EQ(bytes.size(), 200 * kFrame);
    expect_stream(bytes, test_gyro(1000.0), bytes[29]);
  }
  EXPECT_TRUE(present);
}

class UnpluggedLinesTest : public LinesTest {
 protected:
  static config::ScenarioConfig scenario() {
    config::ScenarioConfig out;
    for (const char* const device : {"thermostat", "turntable", "gyro"}) {
      out.faults.push_back(fault(device, config::FaultKind::kUnplug, 40.0, 40.0));
    }
    return out;
  }
  UnpluggedLinesTest() : LinesTest(scenario()) {}
  /// The lines come back one after the other; the gyro's is the last.
  void wait_for_link(const std::string& name) const {
    for (int i = 0; i < 500 && !std::filesystem::exists(tty(name)); ++i) {
      pollfd none{-1, 0, 0};
      poll(&none, 1, 10);
    }
  }
};

TEST_F(UnpluggedLinesTest, HangUpAndComeBackUnderTheSameName) {
  Wire wire(modbus_port());
  Line rtu(tty("thermostat")), turntable(tty("turntable")), gyro(tty("gyro"));
  clock_.jump_to(41.0);
  EXPECT_TRUE(wire.closed());
  EXPECT_TRUE(rtu.hung_up());
  EXPECT_TRUE(turntable.hung_up());
  EXPECT_TRUE(gyro.hung_up());
  EXPECT_FALSE(Wire(modbus_port()).connected());
  EXPECT_FALSE(Line(tty("gyro")).opened());
  clock_.jump_to(81.0);
  wait_for_link("gyro");
  Wire again(modbus_port());
  EXPECT_FALSE(ask(again, kReadTarget).empty());
  EXPECT_EQ(Line(tty("gyro")).receive(36).size(), 36U);
  Line back(tty("turntable"));
  back.send("*IDN?\n");
  EXPECT_EQ(back.line(), "TURNTABLE\n");
}

class FaultyThermostatTest : public LinesTest {
 protected:
  static config::ScenarioConfig scenario() {
    config::ScenarioConfig out;
    out.faults = {fault("thermostat", config::FaultKind::kTimeout, 0.0, 30.0),
                  fault("thermostat", config::FaultKind::kException, 30.0, 30.0),
                  fault("thermostat", config::FaultKind::kBadChecksum, 60.0, 1000.0)};
    return out;
  }
  FaultyThermostatTest() : LinesTest(scenario()) {}
};

TEST_F(FaultyThermostatTest, FaultsAreMetOnTheWire) {
  Wire wire(modbus_port());
  EXPECT_TRUE(ask(wire, kReadTarget, 1, 100).empty()) << "silence";
  clock_.jump_to(32.0);
  EXPECT_THAT(ask(wire, kReadTarget), ElementsAre(0x83, 4));
  clock_.jump_to(62.0);
  Line line(tty("thermostat"));
  line.send(encode_modbus_rtu(1, kReadTarget));
  const Bytes answer = line.receive(7);
  ASSERT_EQ(answer.size(), 7U);
  EXPECT_FALSE(parse_modbus_rtu(answer));
  wire.send(encode_modbus_tcp(8, 1, kReadTarget));
  EXPECT_EQ(be16_at(wire.receive(11), 0), 9) << "nobody's answer";
}

class LateThermostatTest : public LinesTest {
 protected:
  static config::ScenarioConfig scenario() {
    config::ScenarioConfig out;
    out.faults = {fault("thermostat", config::FaultKind::kLateAnswer, 0.0, 1000.0)};
    return out;
  }
  LateThermostatTest() : LinesTest(scenario()) {}
};

TEST_F(LateThermostatTest, AnswersWhenNobodyWaitsAnyMore) {
  Wire wire(modbus_port());
  const double begin_s = now_s();
  EXPECT_EQ(ask(wire, kReadTarget).size(), 4U);
  EXPECT_GE(now_s() - begin_s, 0.75) << "half a second is the deadline";
}

TEST(ServedBench, RefusesSuppliesThatNobodyCouldTellApart) {
  support::TemporaryFolder folder;
  config::BenchConfig bench = test_bench();
  bench.coil_horizontal.serial_number = bench.coil_vertical.serial_number = "S-1";
  const drivers::SteadyClock clock;
  const auto opened = ServedBench::open(bench, {}, 1, {.tty_folder = folder.path()}, clock);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(opened.error().message, testing::HasSubstr("usb:0x1209:0x0002:S-1"));
}

TEST(ServedBench, SaysWhichPortOrFolderItCannotHave) {
  support::TemporaryFolder folder;
  const drivers::SteadyClock clock;
  const auto refusal = [&](const ServeOptions& options) {
    const auto opened = ServedBench::open(test_bench(), {}, 1, options, clock);
    return opened ? std::string() : opened.error().message;
  };
  const auto taken = TcpListener::open("127.0.0.1", 0);
  ASSERT_TRUE(taken);
  EXPECT_THAT(refusal({.modbus_port = taken->port(), .tty_folder = folder.path()}),
              testing::HasSubstr(std::to_string(taken->port()) + ": cannot listen there"));
  EXPECT_THAT(refusal({.address = "nowhere", .tty_folder = folder.path()}),
              testing::HasSubstr("an IPv4 address in numbers was expected"));
  EXPECT_THAT(refusal({.tty_folder = folder / "none"}),
              testing::HasSubstr("cannot be made: No such file"));
}

TEST(ServedBench, TakesItsUsbNumbersFromTheBench) {
  support::TemporaryFolder folder;
  config::BenchConfig bench = test_bench();
  bench.coil_horizontal.connection = "usb:0x0957:0x1234:BOP:1";
  bench.magnetometer.device.vendor_id = 0xABCD;
  bench.magnetometer.device.product_id = 0x0042;
  bench.thermostat.connection = "rtu:/dev/ttyUSB0:19200";
  const drivers::SteadyClock clock;
  const auto opened = ServedBench::open(bench, {}, 1, {.tty_folder = folder.path()}, clock);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto& all = (*opened)->instruments();
  EXPECT_EQ(all[0].also, "rtu:" + (folder / "thermostat").string() + ":19200");
  EXPECT_EQ(all[1].connection, "usb:0x0957:0x1234:BOP:1");
  EXPECT_EQ(all[2].connection, "usb:0x1209:0x0002:coil_vertical");
  EXPECT_EQ(all[3].connection, "hid:0xabcd:0x0042:magnetometer");
}

}  // namespace
}  // namespace fogbench::simulator
