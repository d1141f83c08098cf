#include <cstring>

#include "server/sdf/bank.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/sdf/evaluate_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sdf/warps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

template <class N>
class Machine {
 public:
  HWY_ATTR explicit Machine(const Bank& bank) : bank_(bank) {}

  HWY_ATTR void run(const TapeOp& op) const {
    switch (op.op) {
      case Op::Input:
        return;
      case Op::Affine:
        return move<AffineWarp>(op);
      case Op::Repeat:
        return move<RepeatWarp>(op);
      case Op::Mirror:
        return move<MirrorWarp>(op);
      case Op::Twist:
        return move<TwistWarp>(op);
      case Op::Bend:
        return move<BendWarp>(op);
      case Op::Revolve:
        return move<RevolveWarp>(op);
      case Op::Sphere:
        return shape<SphereShape>(op);
      case Op::Box:
        return shape<BoxShape>(op);
      case Op::Torus:
        return shape<TorusShape>(op);
      case Op::Cylinder:
        return shape<CylinderShape>(op);
      case Op::Cone:
        return shape<ConeShape>(op);
      case Op::Capsule:
        return shape<CapsuleShape>(op);
      case Op::Plane:
        return shape<PlaneShape>(op);
      case Op::Ellipsoid:
        return shape<EllipsoidShape>(op);
      case Op::Octahedron:
        return shape<OctahedronShape>(op);
      case Op::HexPrism:
        return shape<HexPrismShape>(op);
      case Op::Min:
        return join<Join::Lesser>(op);
      case Op::Max:
        return join<Join::Greater>(op);
      case Op::Difference:
        return join<Join::Without>(op);
      case Op::SmoothMin:
        return join<Join::SmoothLesser>(op);
      case Op::SmoothMax:
        return join<Join::SmoothGreater>(op);
      case Op::SmoothDifference:
        return join<Join::SmoothWithout>(op);
      case Op::Offset:
        return change<Change::Offset>(op);
      case Op::Shell:
        return change<Change::Shell>(op);
      case Op::Scale:
        return change<Change::Scale>(op);
      case Op::Waves:
        return displace<WavesWarp>(op);
      case Op::Noise:
        return displace<NoiseWarp>(op);
      case Op::RepeatGuard:
        return displace<RepeatGuardWarp>(op);
      case Op::RadiusGuard:
        return displace<RadiusGuardWarp>(op);
    }
  }

 private:
  enum class Join { Lesser, Greater, Without, SmoothLesser, SmoothGreater, SmoothWithout };
  enum class Change { Offset, Shell, Scale };
  static constexpr bool kSurface = N::kPlanes > 1;

  HWY_INLINE const float* point(std::uint16_t index) const {
    return index == 0 ? bank_.input : new_point(index);
  }
  HWY_INLINE float* new_point(std::uint16_t index) const {
    return bank_.points + 3 * N::kPlanes * bank_.stride * index;
  }
  HWY_INLINE float* distance(std::uint16_t index) const {
    return index == bank_.result ? bank_.output
                                 : bank_.distances + N::kPlanes * bank_.stride * index;
  }
  HWY_INLINE std::int32_t* material(std::uint16_t index) const {
    return bank_.materials + bank_.stride * index;
  }
  HWY_INLINE void copy_material(const TapeOp& op) const {
    if constexpr (kSurface) {
      if (op.a != op.destination)
        std::memcpy(material(op.destination), material(op.a), bank_.count * sizeof(std::int32_t));
    }
  }

  template <class Warp>
  HWY_ATTR HWY_NOINLINE void move(const TapeOp& op) const {
    const Warp warp(op.constants);
    const float* from = point(op.a);
    float* to = new_point(op.destination);
    for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats()))
      store_point(warp(load_point<N>(from + i, bank_.stride)), to + i, bank_.stride);
  }

  template <class Shape>
  HWY_ATTR HWY_NOINLINE void shape(const TapeOp& op) const {
    const Shape solid(op.constants);
    const float* from = point(op.a);
    float* to = distance(op.destination);
    const auto own = hn::Set(Ints(), op.material);
    if (op.combine == Combine::Set) {
      for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats())) {
        store_number(solid(load_point<N>(from + i, bank_.stride)), to + i, bank_.stride);
        if constexpr (kSurface) hn::StoreU(own, Ints(), material(op.destination) + i);
      }
      return;
    }
    for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats())) {
      const N value = solid(load_point<N>(from + i, bank_.stride));
      const N before = load_number(N{}, to + i, bank_.stride);
      if constexpr (kSurface) {
        std::int32_t* materials = material(op.destination) + i;
        const auto wins = hn::RebindMask(Ints(), hn::Lt(value.v, before.v));
        hn::StoreU(hn::IfThenElse(wins, own, hn::LoadU(Ints(), materials)), Ints(), materials);
        store_number(choose(hn::Lt(value.v, before.v), value, before), to + i, bank_.stride);
      } else {
        store_number(lesser(value, before), to + i, bank_.stride);
      }
    }
  }

  template <Join kJoin>
  HWY_INLINE HWY_ATTR static N joined(N a, N b, const float* k) {
    if constexpr (kJoin == Join::Lesser) return lesser(b, a);
    if constexpr (kJoin == Join::Greater) return greater(b, a);
    if constexpr (kJoin == Join::Without) return greater(negate(b), a);
    if constexpr (kJoin == Join::SmoothLesser) return smooth_lesser(a, b, set(k[1]), set(k[2]));
    if constexpr (kJoin == Join::SmoothGreater)
      return negate(smooth_lesser(negate(a), negate(b), set(k[1]), set(k[2])));
    if constexpr (kJoin == Join::SmoothWithout)
      return negate(smooth_lesser(negate(a), b, set(k[1]), set(k[2])));
  }
  /// Whether b's material shows: where b decides the value.
  template <Join kJoin>
  HWY_INLINE HWY_ATTR static FloatMask second_shows(N a, N b) {
    if constexpr (kJoin == Join::Lesser || kJoin == Join::SmoothLesser) return hn::Lt(b.v, a.v);
    if constexpr (kJoin == Join::Greater || kJoin == Join::SmoothGreater) return hn::Gt(b.v, a.v);
    return hn::Gt(hn::Neg(b.v), a.v);
  }
  template <Join kJoin>
  HWY_ATTR HWY_NOINLINE void join(const TapeOp& op) const {
    const float *first = distance(op.a), *second = distance(op.b);
    float* to = distance(op.destination);
    for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats())) {
      const N a = load_number(N{}, first + i, bank_.stride);
      const N b = load_number(N{}, second + i, bank_.stride);
      if constexpr (kSurface) {
        const auto shows = hn::RebindMask(Ints(), second_shows<kJoin>(a, b));
        const auto result = hn::IfThenElse(shows, hn::LoadU(Ints(), material(op.b) + i),
                                           hn::LoadU(Ints(), material(op.a) + i));
        hn::StoreU(result, Ints(), material(op.destination) + i);
      }
      store_number(joined<kJoin>(a, b, op.constants), to + i, bank_.stride);
    }
  }

  template <Change kChange>
  HWY_ATTR HWY_NOINLINE void change(const TapeOp& op) const {
    const auto k = set(op.constants[0]);
    const float* from = distance(op.a);
    float* to = distance(op.destination);
    for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats())) {
      const N a = load_number(N{}, from + i, bank_.stride);
      N result = a;
      if constexpr (kChange == Change::Offset) result = sub(a, k);
      if constexpr (kChange == Change::Shell) result = sub(absolute(a), k);
      if constexpr (kChange == Change::Scale) result = mul(a, k);
      store_number(result, to + i, bank_.stride);
    }
    copy_material(op);
  }

  template <class Warp>
  HWY_ATTR HWY_NOINLINE void displace(const TapeOp& op) const {
    const Warp warp(op.constants);
    const float *from = distance(op.a), *at = point(op.b);
    float* to = distance(op.destination);
    for (std::size_t i = 0; i < bank_.count; i += hn::Lanes(Floats())) {
      const N a = load_number(N{}, from + i, bank_.stride);
      store_number(warp(a, load_point<N>(at + i, bank_.stride)), to + i, bank_.stride);
    }
    copy_material(op);
  }

  Bank bank_;
};

HWY_ATTR void run_plain(const Tape& tape, const Bank& bank) {
  const Machine<Real> machine(bank);
  for (const TapeOp& op : tape.ops) machine.run(op);
}
HWY_ATTR void run_surface(const Tape& tape, const Bank& bank) {
  const Machine<Dual> machine(bank);
  for (const TapeOp& op : tape.ops) machine.run(op);
}

HWY_ATTR void root_vectors(const float* squares, std::size_t count, float* roots) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d))
    hn::Store(root_by_products(hn::Load(d, squares + i)), d, roots + i);
}

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::sdf {

HWY_EXPORT(run_plain);
HWY_EXPORT(run_surface);
HWY_EXPORT(root_vectors);

void run_plain(const Tape& tape, const Bank& bank) {
  HWY_DYNAMIC_DISPATCH(run_plain)(tape, bank);
}
void run_surface(const Tape& tape, const Bank& bank) {
  HWY_DYNAMIC_DISPATCH(run_surface)(tape, bank);
}
void roots_by_products(const float* squares, std::size_t count, float* roots) {
  HWY_DYNAMIC_DISPATCH(root_vectors)(squares, count, roots);
}

}  // namespace macula::sdf
#endif
