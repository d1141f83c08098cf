#include "server/sdf/read.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/sdf/kinds.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

std::string error_of(const std::string& text) {
  const Result<Field> field = parse_field(text, "a.sdf.json");
  EXPECT_FALSE(field.has_value()) << text;
  return field ? "" : field.error().message();
}

void expect_all(const std::string& message, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
}

TEST(ReadField, GivesLineColumnAndRemedyOfBrokenJson) {
  expect_all(error_of("{\n  \"far\": 10,\n  \"scene\": ?\n}"),
             {"a.sdf.json: line 3, column 12", "it must be JSON"});
}

TEST(ReadField, GivesLineAndColumnOfAWrongValue) {
  const std::string text =
      "{\"scene\": {\"type\": \"union\", \"of\": [\n"
      "  {\"type\": \"sphere\", \"radius\": 1},\n"
      "  {\"type\": \"sphere\", \"radius\": -2}\n]}}";
  expect_all(error_of(text), {"line 3, column 32", "radius", "[1e-12, 1e+12]"});
}

TEST(ReadField, NamesEveryNodeTypeToWhoeverMisspelledOne) {
  const std::string message = error_of("{\"scene\": {\"type\": \"spere\"}}");
  expect_all(message, {"line 1, column 20", "'spere'"});
  for (const KindRule& rule : kind_rules())
    EXPECT_NE(message.find(rule.name), std::string::npos) << rule.name;
}

TEST(ReadField, RefusesWhatItDoesNotKnowOrMisses) {
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": 1, "colour": 3}})"),
             {"unknown key 'colour'", "allowed: ", "radius"});
  expect_all(error_of(R"({"scene": {"type": "sphere"}})"), {"lacks \"radius\"", "a number"});
  expect_all(error_of(R"({"far": 10})"), {"lacks \"scene\""});
  expect_all(error_of(R"({"scene": {"type": "union", "of": []}})"), {"works on nothing"});
  expect_all(error_of(R"({"far": 1, "far": 2, "scene": {}})"), {"second time"});
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": 1, "material": "tin"}})"),
             {"no material is called 'tin'", "default"});
  expect_all(error_of(R"({"scene": {"use": "column"}})"), {"nothing is defined as 'column'"});
}

TEST(ReadField, RefusesABoundBelowOne) {
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": 1, "lipschitz": 0.5}})"),
             {"line 1, column 56", "lipschitz", "[1, "});
}

TEST(ReadField, RefusesNumbersThatAreNone) {
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": NaN}})"), {"it must be JSON"});
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": 1e999}})"), {"line 1, column"});
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": 1, "scale": 0}})"), {"scale"});
}

TEST(ReadField, RefusesDefinitionsThatGoInCirclesOrExplode) {
  expect_all(
      error_of(R"({"define": {"a": {"use": "b"}, "b": {"use": "a"}}, "scene": {"use": "a"}})"),
      {"no circle"});
  std::string doubling = R"({"define": {"n0": {"type": "sphere", "radius": 1})";
  for (int i = 1; i <= 20; ++i) {
    const std::string before = "{\"use\": \"n" + std::to_string(i - 1) + "\"}";
    doubling += ", \"n" + std::to_string(i) + "\": {\"type\": \"union\", \"of\": [" + before +
                ", " + before + "]}";
  }
  expect_all(error_of(doubling + "}, \"scene\": {\"use\": \"n20\"}}"), {"too many nodes", "65536"});
}

TEST(ReadField, RefusesNestingBeyondItsLimit) {
  std::string deep = "{\"scene\": ";
  for (int i = 0; i < 200; ++i) deep += R"({"type": "union", "of": )";
  expect_all(error_of(deep), {"nested too deeply", "64"});
}

TEST(ReadField, TakesKeyframes) {
  const Field field =
      scene_of(R"({"type": "sphere", "radius": {"keys": [[0, 1], [2, 3]], "loop": true}})");
  ASSERT_EQ(field.tracks.size(), 1U);
  const Parameter& radius = field.nodes.back().parameters[0];
  EXPECT_DOUBLE_EQ(field.at(radius, 0.0).x, 1.0);
  EXPECT_DOUBLE_EQ(field.at(radius, 0.5).x, 1.5);
  EXPECT_DOUBLE_EQ(field.at(radius, 2.5).x, 1.5);
  EXPECT_DOUBLE_EQ(field.at(radius, -0.5).x, 2.5);
  expect_all(error_of(R"({"scene": {"type": "sphere", "radius": {"keys": [[1, 1], [1, 2]]}}})"),
             {"not a key", "seconds that increase"});
}

TEST(BuiltInFields, CanBeReadAndLookedAt) {
  for (const BuiltInField& each : built_in_fields()) {
    const Field field = built_in(each.name);
    EXPECT_FALSE(field.cameras.empty()) << each.name;
    EXPECT_FALSE(field.nodes.empty()) << each.name;
    EXPECT_TRUE(field.moves()) << each.name;
  }
  EXPECT_EQ(built_in("columns").lights.size(), 5U);
  EXPECT_GE(built_in("temple").nodes.size(), 60U);
}

TEST(BuiltInFields, CostFullSphereTracingManyStepsAtTheTemple) {
  const Field field = built_in("temple");
  const Pose pose = field.pose_of(field.cameras.front(), 0.0);
  TraceOptions options;
  options.method = Method::Full;
  const Traced traced = trace_picture(compile(field, 0.0, pose.position), pose,
                                      ordinary_grid(160, 120, Degrees{50.0}), options);
  const double steps = static_cast<double>(traced.counts.ray_evaluations);
  EXPECT_GT(steps / static_cast<double>(traced.counts.rays), 40.0);
}

}  // namespace
}  // namespace macula::sdf
