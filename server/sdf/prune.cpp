#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sdf/tape.h"
#include "shared/base/check.h"

namespace macula::sdf {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Roundings of a value, relative to the numbers it came from.
constexpr float kRounding = 1e-5F;

/// What a value can be in the ball, and above which bound it does not matter there.
struct Range {
  float low = 0.0F, high = 0.0F;
};

// Goes from the result to the operands. `limit_` of a value: wherever the value is above it in the
// ball, the result stays the same for every other value above it. Each distance has one reader, so
// limits pass down once.
class Pruner {
 public:
  Pruner(std::span<const Instruction> code, const std::vector<float>& constants,
         const Recording& centre, float radius)
      : code_(code), constants_(constants), centre_(centre), radius_(radius) {
    limit_.assign(code.size(), kInfinity);
    stands_for_.assign(code.size(), kDropped);
  }

  std::vector<Instruction> run() {
    const auto result = static_cast<std::uint32_t>(code_.size() - 1);
    want(0, kInfinity);
    want(result, kInfinity);
    for (std::uint32_t i = result; i > 0; --i) {
      if (stands_for_[i] == i) visit(i);
    }
    return collect();
  }

 private:
  Range range(std::uint32_t index) const {
    const float value = centre_.distances[index * centre_.stride];
    if (!std::isfinite(value) || index > jumps_above_) return {-kInfinity, kInfinity};
    const float reach = code_[index].lipschitz * radius_;
    const float slack = kRounding * (std::abs(value) + reach);
    return {value - reach - slack, value + reach + slack};
  }
  float limit(std::uint32_t i) const { return limit_[i]; }
  void want(std::uint32_t i, float limit) {
    stands_for_[i] = i;
    limit_[i] = limit;
  }
  /// The instruction is left out, its reader takes `operand` instead.
  void replace(std::uint32_t i, std::uint32_t operand, float limit) {
    want(operand, limit);
    stands_for_[i] = operand;
  }

  void visit(std::uint32_t i) {
    const Instruction& code = code_[i];
    const float* k = constants_.data() + code.constants;
    const std::uint32_t a = code.a, b = code.b;
    switch (code.op) {
      case Op::Input:
        return;
      case Op::Min:
        return lower_of(i, a, b, 0.0F);
      case Op::SmoothMin:
        return lower_of(i, a, b, k[0]);
      case Op::Max:
        return upper_of(i, a, b, 0.0F);
      case Op::SmoothMax:
        return upper_of(i, a, b, k[0]);
      case Op::Difference:
        return without(i, a, b, 0.0F);
      case Op::SmoothDifference:
        return without(i, a, b, k[0]);
      case Op::Offset:
        return want(a, limit(i) + k[0]);
      case Op::Shell:
        return want(a, kInfinity);
      case Op::Scale:
        return want(a, limit(i) / k[0]);
      case Op::Waves:
        return with_point(a, limit(i) / k[7] + k[6], b);
      case Op::Noise:
        return with_point(a, limit(i) / k[8] + k[9], b);
      case Op::RepeatGuard:
        if (reaches_a_wall(k, b)) jumps_above_ = std::min(jumps_above_, b);
        return with_point(a, limit(i), b);
      case Op::RadiusGuard:
        return with_point(a, limit(i) / k[3], b);
      default:
        stands_for_[a] = a;
        return;  // points and primitives read one point
    }
  }
  void with_point(std::uint32_t distance, float limit, std::uint32_t point) {
    want(distance, limit * (1.0F + kRounding));
    stands_for_[point] = point;
  }
  /// Whether the ball may reach into a second cell: there the values inside the repetition, which
  /// are those of instructions between its point and its guard, jump.
  bool reaches_a_wall(const float* k, std::uint32_t point) const {
    const float reach = code_[point].lipschitz * radius_ * (1.0F + kRounding);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float wall = k[3 + axis];
      const float local = std::abs(centre_.points[(3 * point + axis) * centre_.stride]);
      if (wall > 0.0F && !(std::abs(wall - local) > reach + kRounding * wall)) return true;
    }
    return false;
  }
  void lower_of(std::uint32_t i, std::uint32_t a, std::uint32_t b, float k) {
    const Range ra = range(a), rb = range(b);
    const float limit_a = std::min(limit(i), rb.high) + k,
                limit_b = std::min(limit(i), ra.high) + k;
    const bool drop_a = ra.low > limit_a, drop_b = rb.low > limit_b;
    if (drop_b && (!drop_a || ra.low <= rb.low)) return replace(i, a, limit_a);
    if (drop_a) return replace(i, b, limit_b);
    want(a, limit_a);
    want(b, limit_b);
  }
  void upper_of(std::uint32_t i, std::uint32_t a, std::uint32_t b, float k) {
    const Range ra = range(a), rb = range(b);
    if (rb.high + k < ra.low) return replace(i, a, limit(i));
    if (ra.high + k < rb.low) return replace(i, b, limit(i));
    want(a, limit(i));
    want(b, limit(i));
  }
  /// max(a, -b)
  void without(std::uint32_t i, std::uint32_t a, std::uint32_t b, float k) {
    const Range ra = range(a), rb = range(b);
    if (k - rb.low < ra.low) return replace(i, a, limit(i));
    want(a, limit(i));
    want(b, kInfinity);
  }

  std::vector<Instruction> collect() {
    std::vector<Instruction> kept;
    std::vector<std::uint32_t> place(code_.size(), 0);
    for (std::uint32_t i = 0; i < code_.size(); ++i) {
      if (stands_for_[i] == kDropped) continue;
      if (stands_for_[i] != i) {
        place[i] = place[stands_for_[i]];  // operands stand before their readers
        continue;
      }
      place[i] = static_cast<std::uint32_t>(kept.size());
      Instruction& copy = kept.emplace_back(code_[i]);
      copy.a = place[copy.a];
      copy.b = reads_two(copy.op) ? place[copy.b] : 0;
    }
    return kept;
  }

  static constexpr std::uint32_t kDropped = 0xFFFFFFFFU;

  std::span<const Instruction> code_;
  const std::vector<float>& constants_;
  Recording centre_;
  float radius_;
  std::uint32_t jumps_above_ = std::numeric_limits<std::uint32_t>::max();
  std::vector<float> limit_;
  /// Itself where an instruction is kept, its operand where that takes its place, or kDropped.
  std::vector<std::uint32_t> stands_for_;
};

}  // namespace

std::vector<Instruction> pruned(std::span<const Instruction> code,
                                const std::vector<float>& constants, const Recording& centre,
                                float radius_m) {
  MACULA_CHECK(radius_m >= 0.0F && centre.stride > 0);
  return Pruner(code, constants, centre, radius_m).run();
}

}  // namespace macula::sdf
