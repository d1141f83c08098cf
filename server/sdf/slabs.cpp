#include "server/sdf/slabs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Depths below far * 2^-kOctaves share one slab.
constexpr int kOctaves = 40;
/// A slab is about this many times as long as its cone is wide there: short slabs see less, long
/// ones are fewer to prune, which pays for small programs.
constexpr float kLengthOverWidth = 3.0F, kLengthOverWidthOfMany = 1.0F;
constexpr std::size_t kManyInstructions = 150;

/// What costs a point no more operations than this is not pruned further.
constexpr std::size_t kCheapEnough = 60;
/// Fewer lanes than this cost less than pruning for them.
constexpr std::size_t kWorthPruning = 128;

std::uint32_t bits(float t) {
  return std::bit_cast<std::uint32_t>(t);
}

}  // namespace

Cone cone_around(std::span<const Vec3> directions) {
  MACULA_CHECK(!directions.empty());
  Vec3 sum{0.0F};
  for (const Vec3& direction : directions) sum += direction;
  Cone cone;
  cone.axis = glm::normalize(sum);
  float chord = 0.0F;
  for (const Vec3& direction : directions)
    chord = std::max(chord, glm::length(direction - cone.axis));
  cone.half = std::min(1.0F, 0.5F * chord * 1.0001F + 2e-7F);
  return cone;
}

// Slabs of equal share of an octave: the exponent and the first bits of the mantissa of t.
void Slabs::reset(const Program& program, Slabs* outer, const Cone& cone, Pruning pruning) {
  program_ = &program, outer_ = outer, cone_ = cone, pruning_ = pruning;
  count_ = 0;
  prunings_ = 0;
  const bool many = program.code.size() > kManyInstructions;
  const float share = (many ? kLengthOverWidthOfMany : kLengthOverWidth) * 2.0F * cone.half;
  const int split = std::clamp(static_cast<int>(std::lround(-std::log2(share))), 0, 5);
  shift_ = 23 - static_cast<std::uint32_t>(split);
  if (outer) shift_ = std::min(shift_, outer->shift_);
  const float first = std::max(std::ldexp(program.far_m, -kOctaves), 1e-30F);
  first_key_ = bits(first) >> shift_;
  place_.assign((bits(program.far_m) >> shift_) - first_key_ + 2, -1);
}

std::uint32_t Slabs::key_of(float t) const {
  if (pruning_ == Pruning::None) return first_key_;
  return std::max(bits(t) >> shift_, first_key_);
}

Slab& Slabs::of(float t, Registers& registers) {
  const std::uint32_t key = key_of(t);
  const std::size_t index = std::min<std::size_t>(key - first_key_, place_.size() - 1);
  if (place_[index] < 0) {
    place_[index] = static_cast<std::int16_t>(count_);
    return make(key, registers);
  }
  return slabs_[static_cast<std::size_t>(place_[index])];
}

Slab& Slabs::make(std::uint32_t key, Registers& registers) {
  // Slabs are handed out by reference while new ones are made: the table is as large as it gets.
  if (slabs_.size() < place_.size()) slabs_.resize(place_.size());
  const auto place = static_cast<std::int16_t>(count_);
  Slab& slab = slabs_[count_++];
  slab.key = key;
  slab.low = key == first_key_ ? 0.0F : std::bit_cast<float>(key << shift_);
  slab.high = std::bit_cast<float>((key + 1) << shift_);
  slab.tape.ops.clear();
  slab.shared = nullptr;
  slab.open = false;
  slab.seen = 0;
  if (pruning_ == Pruning::None) {
    slab.low = 0.0F, slab.high = std::numeric_limits<float>::infinity();
    slab.code = program_->code;
  } else if (outer_) {
    cut_within(slab, registers);
  } else {
    cut_outermost(slab, registers);
  }
  const std::size_t first = slab.key - first_key_;
  const std::size_t end = pruning_ == Pruning::None ? 1 : (bits(slab.high) >> shift_) - first_key_;
  std::fill(place_.begin() + static_cast<std::ptrdiff_t>(std::min(first, place_.size() - 1)),
            place_.begin() + static_cast<std::ptrdiff_t>(std::min(end, place_.size())), place);
  return slab;
}

Ball Slabs::ball_of(float low, float high) const {
  low *= 1.0F - kSlabMargin, high *= 1.0F + kSlabMargin;
  const float middle = 0.5F * (low + high);
  // |t v - m c|^2 = (t - m)^2 + 4 t m sin^2(th / 2) is largest at the far rim.
  const float along = high - middle, across = 2.0F * cone_.half;
  return {middle * cone_.axis,
          1.0001F * std::sqrt(along * along + high * middle * across * across)};
}

// The octave of the slab, its half, and so on down to the slab itself are looked at together; the
// longest whose ball is free is taken.
void Slabs::cut_outermost(Slab& slab, Registers& registers) {
  const std::uint32_t split = 23 - shift_;
  std::array<Ball, kRecordedPoints> balls;
  PointBatch centres{};
  const auto ends_of = [&](std::uint32_t level) {
    const std::uint32_t shift = 23 - level, prefix = slab.key << shift_ >> shift;
    return std::pair{std::bit_cast<float>(prefix << shift),
                     std::bit_cast<float>((prefix + 1) << shift)};
  };
  for (std::uint32_t level = 0; level <= split; ++level) {
    const auto [low, high] = ends_of(level);
    balls[level] = level == split ? ball_of(slab.low, slab.high) : ball_of(low, high);
    centres.set(level, balls[level].centre);
  }
  const Tape tape = make_recording_tape(program_->code, program_->constants);
  const Recording recording = record(tape, centres, registers);
  const float* distance = recording.distances + tape.result * recording.stride;
  const auto usable = [&](std::uint32_t level) {
    const bool whole = bits(ends_of(level).first) >> shift_ > first_key_;
    return level == split || (whole && distance[level] > balls[level].radius);
  };
  std::uint32_t level = 0;
  while (!usable(level)) ++level;
  if (level < split) {
    std::tie(slab.low, slab.high) = ends_of(level);
    slab.key = bits(slab.low) >> shift_;
    slab.open = true;
  }
  slab.code = pruned(program_->code, program_->constants,
                     {recording.distances + level, recording.points + level, recording.stride},
                     balls[level].radius);
  ++prunings_;
}

void Slabs::cut_within(Slab& slab, Registers& registers) {
  slab.shared = &outer_->of(slab.low, registers);
  outer_->tape_of(*slab.shared, 0, registers);
  slab.operations = slab.shared->operations;
  if (!slab.shared->open || slab.key == first_key_) return;
  slab.low = slab.shared->low, slab.high = slab.shared->high;
  slab.key = bits(slab.low) >> shift_;
}

void Slabs::prune(Slab& slab, const std::vector<Instruction>& from, Registers& registers) {
  const Ball ball = ball_of(slab.low, slab.high);
  PointBatch centre{};
  centre.set(0, ball.centre);
  const Tape recording = make_recording_tape(from, program_->constants);
  slab.code = pruned(from, program_->constants, record(recording, centre, registers), ball.radius);
  ++prunings_;
}

const Tape& Slabs::tape_of(Slab& slab, std::size_t lanes, Registers& registers) {
  // A visit costs at least a vector, however few its lanes are.
  slab.seen += lanes == 0 ? 0 : std::max(lanes, kRecordedPoints);
  if (slab.shared) {
    if (slab.seen < kWorthPruning || slab.shared->operations <= kCheapEnough)
      return slab.shared->tape;
    prune(slab, slab.shared->code, registers);
    slab.shared = nullptr;
  }
  if (slab.tape.ops.empty()) {
    slab.tape = make_tape(slab.code, program_->constants);
    slab.operations = operations_of(slab.tape);
  }
  return slab.tape;
}

Slab* Slabs::nearest_waiting() {
  Slab* nearest = nullptr;
  for (std::size_t i = 0; i < count_; ++i) {
    Slab& slab = slabs_[i];
    if (!slab.waiting.empty() && (!nearest || slab.key < nearest->key)) nearest = &slab;
  }
  return nearest;
}

}  // namespace macula::sdf
