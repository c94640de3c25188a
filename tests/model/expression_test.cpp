#include "model/effects/expression.hpp"

#include <gtest/gtest.h>

#include "model/table/table.hpp"

namespace fogbench::model {
namespace {

class ExpressionTest : public testing::Test {
 protected:
  ExpressionTest() { table_.set_column("x", {1.0, 2.0, 3.0}); }
  Result<Expression> parse(const std::string& text) const {
    return Expression::parse("my_term", text, {"a"}, Signals(table_, 21.0));
  }
  Table table_;
};

TEST_F(ExpressionTest, ComparesButNeverAssigns) {
  for (const char* text : {"x == 2", "x <= 2", "x >= 2", "x != 2", "x==2"}) {
    EXPECT_TRUE(parse(text)) << text;
  }
  for (const char* text : {"a = 3", "x = 3", "x=a", "x += 1", "x -= 1", "x *= 2", "x /= 2"}) {
    const auto expression = parse(text);
    ASSERT_FALSE(expression) << text;
    EXPECT_EQ(expression.error().code, ErrorCode::kBadInput);
    EXPECT_NE(expression.error().message.find("term my_term: found an assignment"),
              std::string::npos)
        << expression.error().message;
  }
  EXPECT_EQ(table_.column("x")[0], 1.0);
}

TEST_F(ExpressionTest, TakesParametersInTheirOrder) {
  const auto expression = parse("x * a + (x == 2)");
  ASSERT_TRUE(expression) << expression.error().message;
  ASSERT_EQ(expression->parameters(), std::vector<std::string>{"a"});
  const std::vector<double> values{10.0};
  const Eigen::VectorXd result = expression->evaluate(Signals(table_, 21.0), values);
  EXPECT_EQ(result, (Eigen::VectorXd(3) << 10.0, 21.0, 30.0).finished());
}

TEST_F(ExpressionTest, SaysWhichFunctionIsUnknownAndWhichAreKnown) {
  const auto message = [this](const std::string& text) { return parse(text).error().message; };
  EXPECT_NE(message("x * tahn(x / a)").find("unknown function tahn; did you mean \"tan"),
            std::string::npos)
      << message("x * tahn(x / a)");
  EXPECT_NE(message("power (x, 2)").find("the functions are abs, acos, "), std::string::npos);
  EXPECT_NE(message("x + xx").find("did you mean \"x\"?"), std::string::npos) << message("x + xx");
  for (const std::string& function : expression_functions()) {
    const std::string text = function == "atan2" ? "atan2(x, 2)" : function + "(x / 4)";
    EXPECT_TRUE(parse(text)) << text;
  }
  EXPECT_TRUE(parse("2 * (x) + 1e3 * (a)"));
}

}  // namespace
}  // namespace fogbench::model
