// Tape: what the evaluator runs. A program, or the part of it that matters inside a ball, with
// registers reused so that they stay in the nearest cache, and each union of a primitive done in
// one pass over its points.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/sdf/program.h"

namespace macula::sdf {

enum class Combine : std::uint8_t {
  Set,  ///< destination = value
  Min,  ///< destination = min(destination, value)
};

struct TapeOp {
  Op op = Op::Input;
  Combine combine = Combine::Set;
  std::uint16_t destination = 0, a = 0, b = 0;  ///< registers of distances or of points, by op
  std::int32_t material = 0;
  const float* constants = nullptr;  ///< in the program, which must outlive the tape
};

struct Tape {
  std::vector<TapeOp> ops;
  std::uint16_t point_registers = 1;  ///< register 0 holds the points asked for
  std::uint16_t distance_registers = 0;
  std::uint16_t result = 0;
};

/// `code` as in Program::code: the last instruction is the result, the first the points asked for.
/// `constants` must outlive the tape.
Tape make_tape(std::span<const Instruction> code, const std::vector<float>& constants);
inline Tape make_tape(const Program& program) {
  return make_tape(program.code, program.constants);
}
Tape make_tape(Program&& program) = delete;  ///< its constants would be gone
/// Registers are counted in 16 bits.
inline constexpr std::size_t kMostRecorded = 65535;
/// The same with a register for each instruction (register = index), so that every value can be
/// read afterwards. At most kMostRecorded instructions.
Tape make_recording_tape(std::span<const Instruction> code, const std::vector<float>& constants);

/// What a recording tape's instructions are at one point: `distances[index * stride]` and
/// `points[(3 * index + axis) * stride]`.
struct Recording {
  const float* distances = nullptr;
  const float* points = nullptr;
  std::size_t stride = 0;
};

/// What the code needs inside a ball of the given radius (m) around the recorded point: branches of
/// unions, intersections and differences that cannot win there are dropped (Barbier et al. 2025),
/// so that the field keeps its bits in the ball. Rounding is allowed for. A value that is not
/// finite keeps its branch.
std::vector<Instruction> pruned(std::span<const Instruction> code,
                                const std::vector<float>& constants, const Recording& centre,
                                float radius_m);

}  // namespace macula::sdf
