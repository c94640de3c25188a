#include "drivers/reckoned_field.hpp"

#include <gtest/gtest.h>

namespace fogbench::drivers {
namespace {

class StillCoil final : public CoilSupply {
 public:
  StillCoil(double current_a, Clock& clock) : current_a_(current_a), clock_(clock) {}
  Result<std::string> identity() override { return std::string("coil"); }
  Status switch_off() override { return {}; }
  Status confirm_off() override { return {}; }
  Status enable() override { return {}; }
  Status set_current(Ampere) override { return {}; }
  Result<CoilReading> read() override {
    if (gone) return Error{ErrorCode::kUnplugged, "coil: gone"};
    return CoilReading{clock_.now(), Ampere{current_a_}, Ampere{current_a_}};
  }
  bool gone = false;

 private:
  double current_a_;
  Clock& clock_;
};

class StillTurntable final : public Turntable {
 public:
  Result<std::string> identity() override { return std::string("table"); }
  Status rotate_to(Degree azimuth) override {
    azimuth_ = azimuth;
    return {};
  }
  Result<Degree> azimuth() override { return azimuth_; }

 private:
  Degree azimuth_{0.0};
};

TEST(ReckonedField, IsTheAmbientFieldAndWhatTheCurrentsMakeInTheGyrosAxes) {
  VirtualClock clock;
  config::BenchConfig bench;
  bench.magnetometer.ambient_ut = {-50.0, 16.0, 1.0};
  bench.coil_horizontal.field_ut_per_a = 100.0;
  bench.coil_vertical.field_ut_per_a = 80.0;
  StillCoil horizontal(0.5, clock), vertical(-0.2, clock);
  StillTurntable table;
  ReckonedField field(bench, horizontal, vertical, table, clock);
  const auto at_0 = field.read();
  ASSERT_TRUE(at_0);
  EXPECT_DOUBLE_EQ(at_0->field[0].value, 0.0);
  EXPECT_DOUBLE_EQ(at_0->field[1].value, 0.0);
  EXPECT_DOUBLE_EQ(at_0->field[2].value, -1.0);
  ASSERT_TRUE(table.rotate_to(Degree{90.0}));
  const auto at_90 = field.read();
  EXPECT_NEAR(at_90->field[1].value, 1.0, 1e-12);
  EXPECT_NEAR(at_90->field[2].value, 0.0, 1e-12);
  vertical.gone = true;
  EXPECT_EQ(field.read().error().code, ErrorCode::kUnplugged);
}

}  // namespace
}  // namespace fogbench::drivers
