// The branches of a program's outermost union in a tree of boxes, asked by ball before anything is
// evaluated: what a branch costs that is too far to matter is the logarithm of their number.
// Positions relative to the program's eye, meters. Immutable; a Query is one thread's memory.
#pragma once

#include <cstdint>
#include <vector>

#include "server/sdf/ball.h"
#include "server/sdf/program.h"

namespace macula::sdf {

class UnionTree {
 public:
  /// Cheap for programs of few branches; else some hundred nanoseconds each.
  explicit UnionTree(const Program& program);

  /// Whether there are so many branches that asking is cheaper than looking at all of them.
  bool pays() const { return !nodes_.empty(); }

  struct Query {
    struct Found {
      std::uint32_t branch = 0;
      float least = 0.0F;  ///< of its value in the ball
    };
    std::vector<Found> found;
    float limit = 0.0F;                ///< the union is nowhere in the ball above it
    std::vector<std::uint32_t> place;  ///< by instruction: where it stands in the new code
    std::vector<std::uint64_t> asked;  ///< by instruction: the question that put it there
    std::uint64_t question = 0;
  };
  /// What the field needs inside a ball: without branches that by their reach (reach.h) are farther
  /// away in all of it than another is anywhere. The field keeps its bits there. Branches whose
  /// reach is not known always stay. Only where it pays.
  std::vector<Instruction> code_in(const Ball& ball, Query& query) const;
  /// Whether branches with a known reach are farther than `near_m` from all of a ball, by their
  /// reaches alone. Only where it pays.
  bool is_free(const Ball& ball, float near_m) const;
  /// The union of the branches whose reach is not known; empty if there are none.
  std::vector<Instruction> endless_code(Query& query) const;

 private:
  struct Branch {
    std::uint32_t root = 0;              ///< its instruction
    std::uint32_t first = 0, count = 0;  ///< its part of needs_
    Ball ball;
    float rate = 1.0F;       ///< with `ball` its reach
    float at_centre = 0.0F;  ///< its value there; +infinity: not known
    float lipschitz = 1.0F;
  };
  /// A leaf holds a part of order_; of other nodes the first child stands behind them.
  struct Node {
    Vec3 low{0.0F}, high{0.0F};          ///< around the balls of its branches
    float rate = 1.0F;                   ///< the least of theirs
    std::uint32_t first = 0, count = 0;  ///< of a leaf; else count is 0
    std::uint32_t second = 0;            ///< the second child
  };

  std::vector<std::uint32_t> branch_roots() const;
  Branch make_branch(std::uint32_t root, std::vector<std::uint32_t>& seen);
  void measure_centres(const Program& program);
  void build(std::uint32_t first, std::uint32_t count);
  Node node_around(std::uint32_t first, std::uint32_t count) const;
  void visit(std::uint32_t node, const Ball& ball, Query& query) const;
  void look_at(std::uint32_t branch, const Ball& ball, Query& query) const;
  bool is_free(std::uint32_t node, const Ball& ball, float near_m) const;
  std::vector<Instruction> joined(Query& query) const;
  void begin(Query& query, std::vector<Instruction>& code) const;
  void append(const Branch& branch, Query& query, std::vector<Instruction>& code) const;
  static float least_of(const Branch& branch, const Ball& ball, float apart);
  static float least_of(const Node& node, const Ball& ball);

  std::vector<Instruction> code_;
  std::vector<Branch> branches_;      ///< in the order of the code
  std::vector<std::uint32_t> needs_;  ///< instructions of branches, ascending but for the input
  std::vector<std::uint32_t> endless_, order_;  ///< branches without and with a reach
  std::vector<Node> nodes_;                     ///< empty: asking does not pay
};

}  // namespace macula::sdf
