// What a union of many branches may leave out before anything is evaluated: branches that cannot
// be the least in a ball, and not one bit of the field there.
#include "server/sdf/union_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/sdf/evaluate.h"
#include "server/sdf/reach.h"
#include "shared/base/text.h"
#include "tests/server/sdf/random_points.h"
#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

const char* const kBounded[] = {
    R"("type": "sphere", "radius": 0.3)",
    R"("type": "box", "half_size": [0.5, 0.1, 0.2], "edge_radius": 0.05)",
    R"("type": "torus", "radius": 0.4, "tube_radius": 0.1)",
    R"("type": "cylinder", "radius": 0.2, "half_height": 0.5, "edge_radius": 0.05)",
    R"("type": "cone", "bottom_radius": 0.4, "top_radius": 0.1, "half_height": 0.3)",
    R"("type": "capsule", "from": [-0.4, 0.1, 0], "to": [0.3, 0, 0.2], "radius": 0.1)",
    R"("type": "ellipsoid", "radii": [0.6, 0.2, 0.3])",
    R"("type": "octahedron", "radius": 0.5)",
    R"("type": "hex_prism", "radius": 0.3, "half_height": 0.2)",
    R"("type": "union", "smooth": 0.3, "of": [{"type": "sphere", "radius": 0.2},
       {"type": "box", "half_size": 0.15, "at": [0.3, 0.2, 0], "rotate_deg": [20, 0, 40]}])",
    R"("type": "difference", "of": [{"type": "box", "half_size": 0.3},
       {"type": "sphere", "radius": 0.35}])",
    R"("type": "intersection", "smooth": 0.1, "of": [{"type": "sphere", "radius": 0.4},
       {"type": "plane", "normal": [0, 1, 1]}])",
    R"("type": "shell", "thickness": 0.05, "of": {"type": "sphere", "radius": 0.3})",
    R"("type": "round", "radius": 0.1, "of": {"type": "ellipsoid", "radii": [0.4, 0.2, 0.2]})",
    R"("type": "waves", "amplitude": 0.05, "wavelength": 0.4,
       "of": {"type": "octahedron", "radius": 0.4})",
    R"("type": "noise", "amplitude": 0.08, "cell": 0.3, "of": {"type": "sphere", "radius": 0.3})",
    R"("type": "sphere", "radius": 0.3, "lipschitz": 2)",
};
const char* const kEndless[] = {
    R"("type": "plane", "normal": [0, 1, 0])",
    R"("type": "repeat", "period": [3, 0, 3], "of": {"type": "sphere", "radius": 0.2})",
    R"("type": "mirror", "axes": [1, 0, 0], "of": {"type": "sphere", "radius": 0.2})",
    R"("type": "twist", "deg_per_m": 60, "within_radius": 1,
       "of": {"type": "box", "half_size": [0.3, 0.5, 0.1]})",
    R"("type": "bend", "deg_per_m": 40, "within_radius": 1,
       "of": {"type": "box", "half_size": [0.5, 0.1, 0.1]})",
};

std::string placed(const char* node, Uniform& uniform, float spread) {
  const auto triple = [&](float size) {
    const float x = size * uniform(), y = size * uniform(), z = size * uniform();
    return base::concat("[", x, ", ", y, ", ", z, "]");
  };
  return base::concat("{", node, R"(, "at": )", triple(spread), R"(, "rotate_deg": )",
                      triple(180.0F), "}");
}

/// Every kind in turn, somewhere within `spread` meters.
Field crowd(int count, bool endless, float spread) {
  Uniform uniform;
  std::string nodes;
  for (int i = 0; i < count; ++i)
    nodes += base::concat(
        i > 0 ? "," : "",
        placed(kBounded[static_cast<std::size_t>(i) % std::size(kBounded)], uniform, spread));
  if (endless) {
    for (const char* node : kEndless) nodes += base::concat(",", placed(node, uniform, spread));
  }
  return scene_of(base::concat(R"({"type": "union", "of": [)", nodes, "]}"));
}

// ---- how far a solid reaches ----

/// Share of points around a reach where the value is less than it allows.
double share_below(const Program& program, const Reach& reach) {
  const Tape tape = make_tape(program);
  Uniform uniform;
  Registers registers;
  PointBatch points{};
  DistanceBatch found{};
  int below = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    const Ball around{reach.ball.centre,
                      reach.ball.radius * (1.0F + 0.1F * static_cast<float>(round % 20))};
    for (std::size_t i = 0; i < kBatch; ++i) points.set(i, uniform.in_ball(around));
    evaluate(tape, points, kBatch, registers, found);
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Vec3 p{points.x[i], points.y[i], points.z[i]};
      const float outside = glm::length(p - reach.ball.centre) - reach.ball.radius;
      below += outside > 0.0F && found.at[i] < reach.rate * outside - 1e-5F ? 1 : 0;
    }
  }
  return static_cast<double>(below) / (kRounds * static_cast<double>(kBatch));
}

TEST(Reach, HoldsAllOfTheSolidOfEveryKind) {
  Uniform uniform;
  for (const char* node : kBounded) {
    const Program program =
        compile(scene_of(placed(node, uniform, 2.0F)), 0.0, DVec3{0.3, -0.2, 0.1});
    const std::optional<Reach> reach = reaches_of(program).back();
    ASSERT_TRUE(reach) << node;
    EXPECT_EQ(share_below(program, *reach), 0.0) << node;
    // A ball half as large does not hold it.
    EXPECT_GT(share_below(program, {{reach->ball.centre, 0.5F * reach->ball.radius}, 1.0F}), 0.0)
        << node;
  }
}

TEST(Reach, IsUnknownOfWhatHasNoEndOrStandsBehindAWarp) {
  Uniform uniform;
  for (const char* node : kEndless) {
    const Program program = compile(scene_of(placed(node, uniform, 2.0F)), 0.0, DVec3{0.0});
    EXPECT_FALSE(reaches_of(program).back()) << node;
  }
}

// ---- what a ball needs ----

/// Points of `ball` whose distance, gradient or material is not the whole program's after the tree
/// was asked for `asked`.
int unequal_in(const Program& program, const UnionTree& tree, UnionTree::Query& query,
               const Ball& asked, const Ball& ball, Uniform& uniform) {
  Registers registers;
  PointBatch points{};
  SurfaceBatch truth{}, found{};
  for (std::size_t i = 0; i < kBatch; ++i) points.set(i, uniform.in_ball(ball));
  evaluate_surface(make_tape(program), points, kBatch, registers, truth);
  const std::vector<Instruction> code = tree.code_in(asked, query);
  evaluate_surface(make_tape(code, program.constants), points, kBatch, registers, found);
  int unequal = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    const bool same = truth.distance[i] == found.distance[i] && truth.x[i] == found.x[i] &&
                      truth.y[i] == found.y[i] && truth.z[i] == found.z[i] &&
                      truth.material[i] == found.material[i];
    unequal += same ? 0 : 1;
  }
  return unequal;
}

TEST(UnionTree, KeepsEveryBitOfTheFieldInABall) {
  for (const bool endless : {false, true}) {
    const Program program = compile(crowd(300, endless, 8.0F), 0.0, DVec3{1.0, 0.5, 2.0});
    const UnionTree tree(program);
    ASSERT_TRUE(tree.pays());
    UnionTree::Query query;
    Uniform uniform;
    int beyond = 0;
    for (int i = 0; i < 60; ++i) {
      const Ball ball{10.0F * Vec3(uniform(), uniform(), uniform()),
                      std::pow(10.0F, -1.0F + uniform())};
      ASSERT_EQ(unequal_in(program, tree, query, ball, ball, uniform), 0) << i;
      const Ball wider{ball.centre, 8.0F * ball.radius};
      beyond += unequal_in(program, tree, query, ball, wider, uniform);
    }
    EXPECT_GT(beyond, 20);  // what a ball does not need is missed outside of it
  }
}

TEST(UnionTree, LeavesOutMostOfManyBranches) {
  const Program program = compile(crowd(2000, false, 30.0F), 0.0, DVec3{0.0});
  const UnionTree tree(program);
  UnionTree::Query query;
  Uniform uniform;
  std::size_t needed = 0;
  for (int i = 0; i < 100; ++i)
    needed += tree.code_in({30.0F * Vec3(uniform(), uniform(), uniform()), 0.1F}, query).size();
  EXPECT_LT(needed, program.code.size());  // together: less than a hundredth each
}

TEST(UnionTree, AlwaysKeepsBranchesThatHaveNoEnd) {
  const Program program = compile(crowd(100, true, 5.0F), 0.0, DVec3{0.0});
  const UnionTree tree(program);
  UnionTree::Query query;
  const std::vector<Instruction> code = tree.code_in({{900.0F, 700.0F, -800.0F}, 0.01F}, query);
  for (const Op op : {Op::Plane, Op::Repeat, Op::Mirror, Op::Twist, Op::Bend})
    EXPECT_EQ(std::ranges::count(code, op, &Instruction::op), 1);
}

TEST(UnionTree, DoesNotPayForFewBranches) {
  EXPECT_FALSE(UnionTree(compile(crowd(10, true, 5.0F), 0.0, DVec3{0.0})).pays());
  EXPECT_FALSE(UnionTree(compile(built_in("columns"), 0.0, DVec3{0.0})).pays());
}

// ---- pictures ----

/// Hits that differ in status, place or material, in parts of all rays.
double share_of_other_hits(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  int other = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    other += a[i].status != b[i].status ||
             (a[i].status == RayStatus::Hit &&
              (a[i].t != b[i].t || a[i].material != b[i].material || a[i].normal != b[i].normal));
  return other / static_cast<double>(a.size());
}

TEST(UnionTree, GivesAPictureTheHitsOfTheWholeProgram) {
  const PixelGrid grid = ordinary_grid(160, 120);
  for (const bool endless : {false, true}) {
    // The crowd's endless solids hold the other side.
    const Pose pose = math::look_at({0.0, 1.0, endless ? -9.0 : 9.0}, DVec3{0.0}, {0.0, 1.0, 0.0});
    const Field field = crowd(120, endless, 4.0F);
    const Program program = compile(field, 0.0, pose.position);
    TraceOptions options;
    options.method = Method::Full;
    const std::vector<Hit> full = trace_picture(program, pose, grid, options).hits;
    for (const Method method : {Method::FullBest, Method::Cones}) {
      options.method = method;
      const std::vector<Hit> found = trace_picture(program, pose, grid, options).hits;
      EXPECT_LT(share_of_other_hits(full, found), 5e-3);
    }
    // From a tenth of a millimeter beside, a picture has other hits.
    const Program beside = compile(field, 0.0, pose.position + DVec3{1e-4, 0.0, 0.0});
    EXPECT_GT(share_of_other_hits(full, trace_picture(beside, pose, grid, options).hits), 0.2);
  }
}

}  // namespace
}  // namespace macula::sdf
