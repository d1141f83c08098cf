#include "server/sdf/evaluate.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "server/sdf/bank.h"
#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Whole vectors of every width.
constexpr std::size_t padded(std::size_t count) {
  return (count + 15) / 16 * 16;
}

}  // namespace

float* AlignedFloats::at_least(std::size_t count) {
  if (count > size_) {
    block_.reset(
        static_cast<float*>(::operator new[](count * sizeof(float), std::align_val_t{64})));
    std::memset(block_.get(), 0, count * sizeof(float));
    size_ = count;
  }
  return block_.get();
}

void evaluate(const Tape& tape, const PointBatch& points, std::size_t count, Registers& registers,
              DistanceBatch& out) {
  MACULA_CHECK(count <= kBatch);
  const std::size_t n = padded(count);
  static_assert(offsetof(PointBatch, y) == kBatch * sizeof(float), "a batch is a register");
  run_plain(tape, {points.x, registers.points.at_least(3 * kBatch * tape.point_registers),
                   registers.distances.at_least(kBatch * tape.distance_registers), out.at,
                   tape.result, nullptr, kBatch, n});
}

void evaluate_surface(const Tape& tape, const PointBatch& points, std::size_t count,
                      Registers& registers, SurfaceBatch& out) {
  MACULA_CHECK(count <= kBatch);
  const std::size_t n = padded(count), planes = 4;
  registers.materials.resize(
      std::max(registers.materials.size(), kBatch * std::size_t{tape.distance_registers}));
  float* const input = registers.points.at_least(3 * planes * kBatch * tape.point_registers);
  const float* from[3] = {points.x, points.y, points.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float* to = input + axis * planes * kBatch;
    std::memcpy(to, from[axis], n * sizeof(float));
    for (std::size_t by = 0; by < 3; ++by)
      std::fill_n(to + (1 + by) * kBatch, n, by == axis ? 1.0F : 0.0F);
  }
  static_assert(offsetof(SurfaceBatch, z) == 3 * kBatch * sizeof(float), "a batch is a register");
  run_surface(
      tape, {input, input, registers.distances.at_least(planes * kBatch * tape.distance_registers),
             out.distance, tape.result, registers.materials.data(), kBatch, n});
  std::memcpy(out.material, registers.materials.data() + kBatch * tape.result,
              n * sizeof(std::int32_t));
}

Recording record(const Tape& tape, const PointBatch& points, Registers& registers) {
  constexpr std::size_t n = kRecordedPoints;
  float* const input = registers.points.at_least(3 * n * tape.point_registers);
  float* const distances = registers.distances.at_least(n * tape.distance_registers);
  std::memcpy(input, points.x, n * sizeof(float));
  std::memcpy(input + n, points.y, n * sizeof(float));
  std::memcpy(input + 2 * n, points.z, n * sizeof(float));
  run_plain(tape,
            {input, input, distances, distances + n * tape.result, tape.result, nullptr, n, n});
  return {distances, input, n};
}

float evaluate_at(const Tape& tape, const Vec3& point) {
  Registers registers;
  PointBatch points{};
  DistanceBatch out{};
  points.set(0, point);
  evaluate(tape, points, 1, registers, out);
  return out.at[0];
}

std::size_t operations_of(const Tape& tape) {
  // By op, counted from the formulas of primitives-inl.h and warps-inl.h for plain numbers.
  const auto cost = [](const TapeOp& op) -> std::size_t {
    switch (op.op) {
      case Op::Input:
        return 0;
      case Op::Affine:
        return 12;
      case Op::Repeat:  // nine an axis that repeats, one for others
        return 3 + 8 * static_cast<std::size_t>(std::count_if(op.constants + 3, op.constants + 6,
                                                              [](float k) { return k > 0.0F; }));
      case Op::Mirror:
        return 9;
      case Op::Twist:
        return 40;
      case Op::Bend:
        return 48;
      case Op::Revolve:
        return 5;
      case Op::Sphere:
        return 8;
      case Op::Box:
        return 20;
      case Op::Torus:
        return 6;
      case Op::Cylinder:
        return 12;
      case Op::Cone:
        return 26;
      case Op::Capsule:
        return 17;
      case Op::Plane:
        return 4;
      case Op::Ellipsoid:
        return 12;
      case Op::Octahedron:
        return 10;
      case Op::HexPrism:
        return 33;
      case Op::Min:
      case Op::Max:
        return 1;
      case Op::Difference:
        return 2;
      case Op::SmoothMin:
        return 9;
      case Op::SmoothMax:
      case Op::SmoothDifference:
        return 12;
      case Op::Offset:
        return 1;
      case Op::Shell:
        return 2;
      case Op::Scale:
        return 1;
      case Op::Waves:
        return 49;
      case Op::Noise:
        return 8 + 135 * static_cast<std::size_t>(op.constants[5]);
      case Op::RepeatGuard:
        return 25;
      case Op::RadiusGuard:
        return 9;
    }
    return 0;
  };
  std::size_t operations = 0;
  for (const TapeOp& op : tape.ops) operations += cost(op) + (op.combine == Combine::Min ? 1 : 0);
  return operations;
}

}  // namespace macula::sdf
