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
constexpr float kLengthOverWidth = 3.0F, kLengthOverWidthOfMany = 1.0F,
                kLengthOverWidthOfTree = 2.0F;
constexpr std::size_t kManyInstructions = 150;

/// What costs a point no more operations than this is not pruned further.
constexpr std::size_t kCheapEnough = 60;
/// Fewer lanes than this cost less than pruning for them: that looks at all of the outer bundle's
/// code.
constexpr std::size_t kWorthPruning = 128;
/// With a tree, which looks at what is near: fewer operations than this.
constexpr std::size_t kWorthAsking = 30000;

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

void Slabs::reset_whole(const Program& program) {
  tree_ = nullptr;
  begin(program, nullptr, {}, Cut::Whole);
}
void Slabs::reset(const Source& source, const Cone& cone) {
  tree_ = source.tree != nullptr && source.tree->pays() ? source.tree : nullptr;
  hit_width_ = source.hit_width, hit_m_ = source.hit_m;
  const std::vector<Instruction> rest = tree_ ? tree_->endless_code(query_) : source.program.code;
  rest_ = rest.empty() ? Tape{} : make_tape(rest, source.program.constants);
  begin(source.program, nullptr, cone, Cut::Outermost);
}
void Slabs::reset_within(Slabs& outer, const Cone& cone) {
  tree_ = outer.tree_;
  hit_width_ = outer.hit_width_, hit_m_ = outer.hit_m_;
  begin(*outer.program_, &outer, cone, Cut::Within);
}

// Slabs of equal share of an octave: the exponent and the first bits of the mantissa of t.
void Slabs::begin(const Program& program, Slabs* outer, const Cone& cone, Cut cut) {
  program_ = &program, outer_ = outer, cone_ = cone, cut_ = cut;
  count_ = 0;
  prunings_ = 0;
  const bool many = program.code.size() > kManyInstructions;
  const float length = tree_  ? kLengthOverWidthOfTree
                       : many ? kLengthOverWidthOfMany
                              : kLengthOverWidth;
  const float share = length * 2.0F * cone.half;
  const int split = std::clamp(static_cast<int>(std::lround(-std::log2(share))), 0, 5);
  shift_ = 23 - static_cast<std::uint32_t>(split);
  if (outer) shift_ = std::min(shift_, outer->shift_);
  const float first = std::max(std::ldexp(program.far_m, -kOctaves), 1e-30F);
  first_key_ = bits(first) >> shift_;
  place_.assign((bits(program.far_m) >> shift_) - first_key_ + 2, -1);
}

std::uint32_t Slabs::key_of(float t) const {
  if (cut_ == Cut::Whole) return first_key_;
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
  slab.code.clear();
  slab.tape.ops.clear();
  slab.shared = nullptr;
  slab.open = false;
  slab.seen = 0;
  if (cut_ == Cut::Whole) {
    slab.low = 0.0F, slab.high = std::numeric_limits<float>::infinity();
    slab.code = program_->code;
  } else if (cut_ == Cut::Within) {
    cut_within(slab, registers);
  } else {
    cut_outermost(slab, registers);
  }
  const std::size_t first = slab.key - first_key_;
  const std::size_t end = cut_ == Cut::Whole ? 1 : (bits(slab.high) >> shift_) - first_key_;
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

Slabs::FreeBalls Slabs::are_free(std::span<const Ball> balls, float high, const Tape& rest,
                                 Registers& registers) const {
  const float width = hit_width_ + kFieldRounding;
  const float near_m = 1.0001F * (width * high * (1.0F + kSlabMargin) + hit_m_);
  PointBatch centres{};
  DistanceBatch found{};
  for (std::size_t i = 0; i < balls.size(); ++i) centres.set(i, balls[i].centre);
  if (!rest.ops.empty()) evaluate(rest, centres, balls.size(), registers, found);
  FreeBalls free{};
  for (std::size_t i = 0; i < balls.size(); ++i) {
    free[i] = rest.ops.empty() || found.at[i] > balls[i].radius + near_m;
    if (tree_ && free[i]) free[i] = tree_->is_free(balls[i], near_m);
  }
  return free;
}

// The octave of the slab, its half, and so on are looked at together; the longest whose ball is
// free is taken, else the slab itself.
void Slabs::cut_outermost(Slab& slab, Registers& registers) {
  if (slab.key == first_key_) return;
  const std::uint32_t split = 23 - shift_;
  std::array<Ball, kRecordedPoints> balls;
  const auto ends_of = [&](std::uint32_t level) {
    const std::uint32_t shift = 23 - level, prefix = slab.key << shift_ >> shift;
    return std::pair{std::bit_cast<float>(prefix << shift),
                     std::bit_cast<float>((prefix + 1) << shift)};
  };
  for (std::uint32_t level = 0; level <= split; ++level)
    balls[level] = ball_of(ends_of(level).first, ends_of(level).second);
  const FreeBalls free = are_free({balls.data(), split + 1}, ends_of(0).second, rest_, registers);
  for (std::uint32_t level = 0; level <= split && !slab.open; ++level) {
    const auto [low, high] = ends_of(level);
    const bool whole = level == split || bits(low) >> shift_ > first_key_;
    if (!whole || !free[level]) continue;
    slab.low = low, slab.high = high;
    slab.key = bits(low) >> shift_;
    slab.open = true;
  }
}

void Slabs::cut_within(Slab& slab, Registers& registers) {
  slab.shared = &outer_->of(slab.low, registers);
  if (slab.key == first_key_) return;
  if (slab.shared->open) {
    slab.low = slab.shared->low, slab.high = slab.shared->high;
    slab.key = bits(slab.low) >> shift_;
  }
  slab.open = slab.shared->open;
  if (slab.open) return;
  const Ball ball = ball_of(slab.low, slab.high);
  const Tape& rest = tree_ ? outer_->rest_ : outer_->tape_of(*slab.shared, 0, registers);
  slab.open = are_free({&ball, 1}, slab.high, rest, registers)[0];
}

void Slabs::prune(Slab& slab, const std::vector<Instruction>& from, Registers& registers) {
  const Ball ball = ball_of(slab.low, slab.high);
  if (tree_) slab.code = tree_->code_in(ball, query_);
  const std::vector<Instruction>& code = tree_ ? slab.code : from;
  if (code.size() > kMostRecorded) {  // nothing can be said of so many
    slab.code = std::vector<Instruction>(code);
    return;
  }
  PointBatch centre{};
  centre.set(0, ball.centre);
  const Tape recording = make_recording_tape(code, program_->constants);
  slab.code = pruned(code, program_->constants, record(recording, centre, registers), ball.radius);
  ++prunings_;
}

/// Whether so many lanes have come that a program pruned for them saves more than it costs.
bool Slabs::pays(const Slab& slab) const {
  if (slab.operations <= kCheapEnough) return false;
  return tree_ ? slab.seen * slab.operations >= kWorthAsking : slab.seen >= kWorthPruning;
}

const Tape& Slabs::tape_of(Slab& slab, std::size_t lanes, Registers& registers) {
  // A visit costs at least a vector, however few its lanes are.
  slab.seen += lanes == 0 ? 0 : std::max(lanes, kRecordedPoints);
  if (slab.shared) {
    const Tape& tape = outer_->tape_of(*slab.shared, 0, registers);
    slab.operations = slab.shared->operations;
    if (!pays(slab)) return tape;
    prune(slab, slab.shared->code, registers);
    slab.shared = nullptr;
  }
  if (slab.tape.ops.empty()) {
    if (slab.code.empty()) prune(slab, program_->code, registers);
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
