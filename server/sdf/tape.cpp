#include "server/sdf/tape.h"

#include <algorithm>

#include "shared/base/check.h"

namespace macula::sdf {
namespace {

constexpr std::uint32_t kNever = 0xFFFFFFFFU;

/// Registers handed out lowest first, so that few are used.
class RegisterPool {
 public:
  std::uint16_t take() {
    if (free_.empty()) return static_cast<std::uint16_t>(count_++);
    const auto lowest = std::min_element(free_.begin(), free_.end());
    const std::uint16_t taken = *lowest;
    *lowest = free_.back();
    free_.pop_back();
    return taken;
  }
  void give(std::uint16_t one) { free_.push_back(one); }
  std::uint16_t count() const { return static_cast<std::uint16_t>(count_); }

 private:
  std::vector<std::uint16_t> free_;
  std::size_t count_ = 0;
};

class TapeMaker {
 public:
  TapeMaker(std::span<const Instruction> code, const std::vector<float>& constants)
      : code_(code), constants_(constants) {
    last_use_.assign(code.size(), kNever);
    register_.assign(code.size(), 0);
    for (std::uint32_t i = 1; i < code.size(); ++i) {
      last_use_[code[i].a] = i;
      if (reads_two(code[i].op)) last_use_[code[i].b] = i;
    }
    last_use_[0] = kNever;  // the points asked for stay
    register_[0] = points_.take();
  }

  Tape run() {
    for (std::uint32_t i = 1; i < code_.size(); ++i) {
      if (joins_next(i)) {
        join(i);
        ++i;
      } else {
        place(i);
      }
    }
    tape_.point_registers = points_.count();
    tape_.distance_registers = distances_.count();
    tape_.result = register_.back();
    return std::move(tape_);
  }

 private:
  /// A primitive whose only use is the union that follows it.
  bool joins_next(std::uint32_t i) const {
    return i + 1 < code_.size() && is_primitive(code_[i].op) && code_[i + 1].op == Op::Min &&
           code_[i + 1].b == i && code_[i + 1].a != i;
  }
  void join(std::uint32_t i) {
    const std::uint32_t sum = code_[i + 1].a;
    append(i, Combine::Min, register_[sum], register_[code_[i].a], 0);
    release(code_[i].a, i);
    register_[i + 1] = register_[sum];
  }
  void place(std::uint32_t i) {
    const Instruction& code = code_[i];
    const bool two = reads_two(code.op);
    const std::uint16_t a = register_[code.a], b = two ? register_[code.b] : 0;
    release(code.a, i);
    if (two && code.b != code.a) release(code.b, i);
    // Operations read a position before they write it: an operand's register may be the result's.
    register_[i] = (makes_point(code.op) ? points_ : distances_).take();
    append(i, Combine::Set, register_[i], a, b);
  }
  void release(std::uint32_t operand, std::uint32_t i) {
    if (last_use_[operand] != i) return;
    (makes_point(code_[operand].op) ? points_ : distances_).give(register_[operand]);
  }
  void append(std::uint32_t i, Combine combine, std::uint16_t to, std::uint16_t a,
              std::uint16_t b) {
    tape_.ops.push_back({code_[i].op, combine, to, a, b, code_[i].material,
                         constants_.data() + code_[i].constants});
  }

  std::span<const Instruction> code_;
  const std::vector<float>& constants_;
  std::vector<std::uint32_t> last_use_;  ///< the last reader, by instruction
  std::vector<std::uint16_t> register_;  ///< by instruction
  RegisterPool points_, distances_;
  Tape tape_;
};

}  // namespace

Tape make_tape(std::span<const Instruction> code, const std::vector<float>& constants) {
  MACULA_CHECK(code.size() >= 2, "code holds the input and a result");
  return TapeMaker(code, constants).run();
}

Tape make_recording_tape(std::span<const Instruction> code, const std::vector<float>& constants) {
  MACULA_CHECK(code.size() >= 2 && code.size() <= kMostRecorded, "registers are counted in 16 bits");
  Tape tape;
  const auto count = static_cast<std::uint16_t>(code.size());
  for (std::uint16_t i = 1; i < count; ++i) {
    tape.ops.push_back({code[i].op, Combine::Set, i, static_cast<std::uint16_t>(code[i].a),
                        static_cast<std::uint16_t>(code[i].b), code[i].material,
                        constants.data() + code[i].constants});
  }
  tape.point_registers = tape.distance_registers = count;
  tape.result = static_cast<std::uint16_t>(count - 1);
  return tape;
}

}  // namespace macula::sdf
