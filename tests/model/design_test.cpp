// The derivatives that the fit uses, against finite differences of another order and step.

#include "model/fit/design.hpp"
#include "model/effects/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::model {
namespace {

Table varied_session() {
  std::vector<double> time, duration, temperature, field, azimuth;
  for (int i = 0; i < 60; ++i) {
    time.push_back(60.0 + 100.0 * i);
    duration.push_back(80.0);
    temperature.push_back(35.0 + 14.0 * std::sin(0.13 * i));
    field.push_back(280.0 * std::sin(0.31 * i));
    azimuth.push_back(6.0 * i);
  }
  Table table;
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("temperature_c", temperature);
  for (const char* axis : {"field_x_ut", "field_y_ut", "field_z_ut"}) table.set_column(axis, field);
  return table;
}

TEST(Design, RefusesAnotherUnitThanTheCataloguesForItsEffects) {
  const Table table = varied_session();
  const Signals signals(table, 21.0);
  config::ModelFile model;
  config::ModelTerm& term = model.terms.emplace_back();
  term.effect = "magnetic_linear_z";
  term.unit = "deg/h per 100 uT";
  EXPECT_TRUE(Design::make(signals, model, false));
  term.unit = "deg/s";
  const auto refused = Design::make(signals, model, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "term magnetic_linear_z: has the unit \"deg/s\", expected the catalogue's \"deg/h per "
            "100 uT\"");
}

TEST(Design, DerivativesByInnerParametersAgreeWithFiniteDifferences) {
  const Table table = varied_session();
  const Signals signals(table, 21.0);
  int checked = 0;
  for (const Effect* effect : catalogue()) {
    if (effect->info().parameters.empty()) continue;
    config::ModelFile model;
    model.terms.emplace_back().effect = std::string(effect->info().id);
    const auto design = Design::make(signals, model, false);
    ASSERT_TRUE(design) << design.error().message;
    const InnerParameter& range = *design->parameters()[0].range;
    // Away from the kinks of steps and plays, which have no derivative there.
    Eigen::VectorXd inner(1);
    inner[0] = range.minimum + 0.37123 * (range.maximum - range.minimum);
    Eigen::MatrixXd rows;
    design->visit(inner, true, signals.signal("time_s"),
                  [&](std::size_t, Eigen::Ref<Eigen::MatrixXd> block) { rows = block; });
    const auto columns = static_cast<Eigen::Index>(effect->info().columns.size());
    const double h = 3e-6 * inner[0];
    const Eigen::VectorXd up = inner.array() + h, down = inner.array() - h;
    const Eigen::MatrixXd difference =
        (design->regressor(0, up) - design->regressor(0, down)).leftCols(columns) / (2.0 * h);
    const auto free = static_cast<Eigen::Index>(design->free_columns().size());
    const Eigen::MatrixXd derivative = rows.middleCols(free, columns);
    const double scale = difference.cwiseAbs().maxCoeff();
    EXPECT_GT(scale, 0.0) << effect->info().id;
    EXPECT_LT((derivative - difference).cwiseAbs().maxCoeff(), 1e-5 * scale) << effect->info().id;
    ++checked;
  }
  EXPECT_EQ(checked, 15);
}

}  // namespace
}  // namespace fogbench::model
