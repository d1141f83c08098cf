#include "server/sdf/union_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sdf/evaluate.h"
#include "server/sdf/reach.h"
#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Fewer branches than this are looked at one by one as fast.
constexpr std::size_t kWorthAsking = 24;
constexpr std::uint32_t kLeafBranches = 4;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Roundings of a distance, relative to the coordinates it is made of.
constexpr float kRounding = 1e-5F;

float slack(const Vec3& at, float distance, float radius) {
  return kRounding * (std::abs(at.x) + std::abs(at.y) + std::abs(at.z) + distance + radius);
}
/// From a point to a box; 0 inside.
float distance_to(const Vec3& low, const Vec3& high, const Vec3& p) {
  return glm::length(glm::max(glm::max(low - p, p - high), Vec3{0.0F}));
}
bool is_finite(const Reach& reach) {
  const Vec3& c = reach.ball.centre;
  return std::isfinite(c.x + c.y + c.z + reach.ball.radius) && reach.rate > 0.0F;
}

}  // namespace

UnionTree::UnionTree(const Program& program) : code_(program.code) {
  const std::vector<std::uint32_t> roots = branch_roots();
  if (roots.size() < kWorthAsking) return;
  const std::vector<std::optional<Reach>> reaches = reaches_of(program);
  std::vector<std::uint32_t> seen(code_.size(), 0);
  for (const std::uint32_t root : roots) {
    Branch& branch = branches_.emplace_back(make_branch(root, seen));
    const std::optional<Reach>& reach = reaches[root];
    const bool known = reach && is_finite(*reach);
    if (known) branch.ball = reach->ball, branch.rate = reach->rate;
    (known ? order_ : endless_).push_back(static_cast<std::uint32_t>(branches_.size() - 1));
  }
  if (order_.size() < kWorthAsking) return;
  measure_centres(program);
  build(0, static_cast<std::uint32_t>(order_.size()));
}

/// Operands of the outermost Min and of those that it joins, in the order of the code.
std::vector<std::uint32_t> UnionTree::branch_roots() const {
  std::vector<std::uint32_t> roots, open{static_cast<std::uint32_t>(code_.size() - 1)};
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    if (code_[i].op != Op::Min) {
      roots.push_back(i);
      continue;
    }
    open.push_back(code_[i].b);
    open.push_back(code_[i].a);
  }
  std::ranges::sort(roots);
  return roots;
}

/// `seen`, by instruction, holds the number of the last branch that needed it.
UnionTree::Branch UnionTree::make_branch(std::uint32_t root, std::vector<std::uint32_t>& seen) {
  const auto number = static_cast<std::uint32_t>(branches_.size() + 1);
  const std::size_t first = needs_.size();
  needs_.push_back(root);
  for (std::size_t i = first; i < needs_.size(); ++i) {
    const Instruction& code = code_[needs_[i]];
    for (const std::uint32_t operand : {code.a, reads_two(code.op) ? code.b : 0U}) {
      if (operand == 0 || seen[operand] == number) continue;
      seen[operand] = number;
      needs_.push_back(operand);
    }
  }
  std::sort(needs_.begin() + static_cast<std::ptrdiff_t>(first), needs_.end());
  Branch branch;
  branch.root = root;
  branch.first = static_cast<std::uint32_t>(first);
  branch.count = static_cast<std::uint32_t>(needs_.size() - first);
  branch.lipschitz = code_[root].lipschitz;
  return branch;
}

void UnionTree::measure_centres(const Program& program) {
  Query query;
  Registers registers;
  PointBatch points{};
  DistanceBatch found{};
  std::vector<Instruction> code;
  for (const std::uint32_t i : order_) {
    Branch& branch = branches_[i];
    begin(query, code);
    append(branch, query, code);
    points.set(0, branch.ball.centre);
    evaluate(make_tape(code, program.constants), points, 1, registers, found);
    branch.at_centre = std::isfinite(found.at[0]) ? found.at[0] : kInfinity;
  }
}

/// Of part [first, first + count) of order_: halves at the median along the longest side.
void UnionTree::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t place = nodes_.size();
  nodes_.push_back(node_around(first, count));
  if (count <= kLeafBranches) return;
  const Vec3 size = nodes_[place].high - nodes_[place].low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const float ca = branches_[a].ball.centre[axis], cb = branches_[b].ball.centre[axis];
    return ca != cb ? ca < cb : a < b;
  });
  nodes_[place].count = 0;
  build(first, half);
  nodes_[place].second = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half);
}

UnionTree::Node UnionTree::node_around(std::uint32_t first, std::uint32_t count) const {
  Node node{Vec3{kInfinity}, Vec3{-kInfinity}, 1.0F, first, count, 0};
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Branch& branch = branches_[order_[i]];
    node.low = glm::min(node.low, branch.ball.centre - branch.ball.radius);
    node.high = glm::max(node.high, branch.ball.centre + branch.ball.radius);
    node.rate = std::min(node.rate, branch.rate);
  }
  return node;
}

/// Of its values in the ball, `apart` the way between both centres; -infinity: not known.
float UnionTree::least_of(const Branch& branch, const Ball& ball, float apart) {
  const float outside = apart - branch.ball.radius - ball.radius;
  const float unsure = slack(ball.centre, apart + branch.ball.radius, ball.radius);
  return outside > 0.0F ? branch.rate * outside - unsure : -kInfinity;
}
float UnionTree::least_of(const Node& node, const Ball& ball) {
  const float apart = distance_to(node.low, node.high, ball.centre);
  const float outside = apart - ball.radius;
  const float unsure = slack(ball.centre, apart, ball.radius);
  return outside > 0.0F ? node.rate * outside - unsure : -kInfinity;
}

void UnionTree::look_at(std::uint32_t number, const Ball& ball, Query& query) const {
  const Branch& branch = branches_[number];
  const float apart = glm::length(ball.centre - branch.ball.centre);
  const float least = least_of(branch, ball, apart);
  if (least > query.limit) return;
  query.found.push_back({number, least});
  const float unsure = slack(ball.centre, apart + branch.ball.radius, ball.radius);
  const float most = branch.at_centre + branch.lipschitz * (apart + ball.radius) + unsure;
  query.limit = std::min(query.limit, most);
}

/// Nearer children first: what they hold spares the look at others.
void UnionTree::visit(std::uint32_t number, const Ball& ball, Query& query) const {
  const Node& node = nodes_[number];
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
    look_at(order_[i], ball, query);
  if (node.count > 0) return;
  std::uint32_t near = number + 1, far = node.second;
  float near_least = least_of(nodes_[near], ball), far_least = least_of(nodes_[far], ball);
  if (far_least < near_least) std::swap(near, far), std::swap(near_least, far_least);
  if (near_least <= query.limit) visit(near, ball, query);
  if (far_least <= query.limit) visit(far, ball, query);
}

bool UnionTree::is_free(std::uint32_t number, const Ball& ball, float near_m) const {
  const Node& node = nodes_[number];
  if (least_of(node, ball) > near_m) return true;
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const Branch& branch = branches_[order_[i]];
    const float apart = glm::length(ball.centre - branch.ball.centre);
    if (!(least_of(branch, ball, apart) > near_m)) return false;
  }
  return node.count > 0 ||
         (is_free(number + 1, ball, near_m) && is_free(node.second, ball, near_m));
}

bool UnionTree::is_free(const Ball& ball, float near_m) const {
  MACULA_CHECK(pays());
  return is_free(0, ball, near_m);
}

void UnionTree::begin(Query& query, std::vector<Instruction>& code) const {
  query.place.resize(code_.size(), 0);
  query.asked.resize(code_.size(), 0);
  ++query.question;
  code.assign(1, code_.front());
}

void UnionTree::append(const Branch& branch, Query& query, std::vector<Instruction>& code) const {
  for (std::uint32_t n = branch.first; n < branch.first + branch.count; ++n) {
    const std::uint32_t i = needs_[n];
    if (query.asked[i] == query.question) continue;  // a point that a branch before needed too
    query.asked[i] = query.question;
    query.place[i] = static_cast<std::uint32_t>(code.size());
    Instruction& copy = code.emplace_back(code_[i]);
    copy.a = query.place[copy.a];
    copy.b = reads_two(copy.op) ? query.place[copy.b] : 0;
  }
}

/// What was found, in the order of the code: it decides which of two equal branches shows.
std::vector<Instruction> UnionTree::joined(Query& query) const {
  std::ranges::sort(query.found, {}, &Query::Found::branch);
  std::vector<Instruction> code;
  begin(query, code);
  std::uint32_t sum = 0;
  for (const Query::Found& one : query.found) {
    append(branches_[one.branch], query, code);
    const auto last = static_cast<std::uint32_t>(code.size() - 1);
    if (sum != 0) {
      Instruction& join = code.emplace_back(code_.back());
      join.a = sum, join.b = last;
    }
    sum = static_cast<std::uint32_t>(code.size() - 1);
  }
  return code;
}

std::vector<Instruction> UnionTree::code_in(const Ball& ball, Query& query) const {
  MACULA_CHECK(pays());
  query.found.clear();
  query.limit = kInfinity;
  visit(0, ball, query);
  std::erase_if(query.found, [&](const Query::Found& one) { return one.least > query.limit; });
  for (const std::uint32_t branch : endless_) query.found.push_back({branch, -kInfinity});
  return joined(query);
}

std::vector<Instruction> UnionTree::endless_code(Query& query) const {
  query.found.clear();
  if (endless_.empty()) return {};
  for (const std::uint32_t branch : endless_) query.found.push_back({branch, -kInfinity});
  return joined(query);
}

}  // namespace macula::sdf
