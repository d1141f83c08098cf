#include "server/reconstruction/history_rows.h"

#include <algorithm>

#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/reconstruction/history_rows_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::reconstruction::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- which places are known ----

/// Where a place lies between cells' centres on one axis; beyond the outermost ones, on them.
template <class D>
struct Between {
  hn::Vec<D> first, fraction;
};
template <class D>
HWY_INLINE HWY_ATTR Between<D> between(D d, hn::Vec<D> place, int size) {
  const auto centred = hn::Sub(place, hn::Set(d, 0.5F)), zero = hn::Zero(d);
  const auto last = hn::Set(d, static_cast<float>(size - 2));
  const auto first = hn::Min(hn::Max(hn::Floor(centred), zero), last);
  return {first, hn::Min(hn::Max(hn::Sub(centred, first), zero), hn::Set(d, 1.0F))};
}

/// Shares of the four cells from `first` on: bilinear among the known ones. Where these have next
/// to no share, by mere rounding of the place, they get equal ones.
template <class D>
HWY_INLINE HWY_ATTR void share_out(D d, const image::Plane<float>& depths, std::size_t i,
                                   RowReads& reads) {
  const hn::RebindToSigned<D> di;
  const std::ptrdiff_t stride = depths.width();
  const auto first = hn::LoadU(di, reads.first.data() + i);
  const auto across = hn::LoadU(d, reads.across.data() + i);
  const auto down = hn::LoadU(d, reads.down.data() + i);
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const auto known = [&](std::ptrdiff_t offset) HWY_ATTR {
    const auto depth = hn::GatherIndex(d, depths.data() + offset, first);
    return hn::IfThenElseZero(hn::Ge(depth, zero), one);
  };
  const auto k0 = known(0), k1 = known(1), k2 = known(stride), k3 = known(stride + 1);
  const auto left = hn::Sub(one, across), up = hn::Sub(one, down);
  const auto w0 = hn::Mul(k0, hn::Mul(left, up)), w1 = hn::Mul(k1, hn::Mul(across, up));
  const auto w2 = hn::Mul(k2, hn::Mul(left, down)), w3 = hn::Mul(k3, hn::Mul(across, down));
  const auto sum = hn::Add(hn::Add(w0, w1), hn::Add(w2, w3));
  const auto usable = hn::Gt(sum, hn::Set(d, 1e-3F));
  const auto count = hn::Max(hn::Add(hn::Add(k0, k1), hn::Add(k2, k3)), one);
  const auto scale = hn::Div(one, hn::IfThenElse(usable, sum, count));
  hn::StoreU(hn::Mul(scale, hn::IfThenElse(usable, w0, k0)), d, reads.share[0].data() + i);
  hn::StoreU(hn::Mul(scale, hn::IfThenElse(usable, w1, k1)), d, reads.share[1].data() + i);
  hn::StoreU(hn::Mul(scale, hn::IfThenElse(usable, w2, k2)), d, reads.share[2].data() + i);
  hn::StoreU(hn::Mul(scale, hn::IfThenElse(usable, w3, k3)), d, reads.share[3].data() + i);
}

/// Whether all cells of a small rectangle are known; false for what is too large or reaches out.
HWY_INLINE HWY_ATTR bool knows_all(const image::Plane<float>& depths, int left, int top, int right,
                                   int bottom) {
  const hn::ScalableTag<float> d;
  constexpr int kMostSteps = 4, kMostRows = 8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int steps = (right - left + lanes - 1) / lanes;
  if (left < 0 || top < 0 || right > depths.width() || bottom > depths.height()) return false;
  if (steps > kMostSteps || bottom - top > kMostRows || steps * lanes > depths.width())
    return false;
  const int start = std::min(left, depths.width() - steps * lanes);
  auto least = hn::Zero(d);
  for (int y = top; y < bottom; ++y) {
    const float* row = &depths(start, y);
    for (int k = 0; k < steps; ++k) least = hn::Min(least, hn::LoadU(d, row + k * lanes));
  }
  return hn::AllTrue(d, hn::Ge(least, hn::Zero(d)));
}

/// Whether all sixteen cells around a place are known.
HWY_INLINE HWY_ATTR bool knows_sixteen(const image::Plane<float>& depths, int x, int y) {
  const hn::FixedTag<float, 4> d;
  if (x < 1 || y < 1 || x + 3 > depths.width() || y + 3 > depths.height()) return false;
  const float* at = &depths(x - 1, y - 1);
  auto least = hn::LoadU(d, at);
  for (int j = 1; j < 4; ++j) least = hn::Min(least, hn::LoadU(d, at + j * depths.width()));
  return hn::AllTrue(d, hn::Ge(least, hn::Zero(d)));
}

/// What a vector of places is known from.
template <class D>
HWY_INLINE HWY_ATTR void know(D d, const ReadJob& job, hn::Mask<D> same,
                              hn::Vec<hn::RebindToSigned<D>> x, hn::Vec<hn::RebindToSigned<D>> y,
                              std::size_t i, RowReads& reads) {
  const hn::RebindToSigned<D> di;
  constexpr std::size_t kMostLanes = HWY_MAX_BYTES / sizeof(std::int32_t);
  const auto found = hn::RebindMask(di, same);
  const bool bicubic = job.reading == Reading::Bicubic;
  const image::Plane<float>& depths = job.inverse_depth;
  const auto least = [&](auto v) HWY_ATTR {
    return hn::GetLane(hn::MinOfLanes(di, hn::IfThenElse(found, v, hn::Set(di, INT32_MAX))));
  };
  const auto most = [&](auto v) HWY_ATTR {
    return hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(found, v)));
  };
  Known* known = reads.known.data() + i;
  if (hn::AllFalse(d, same)) {
    std::fill_n(known, hn::Lanes(d), Known::Nothing);
    return;
  }
  static_assert(sizeof(Known) == 1 && static_cast<int>(Known::Nothing) == 0);
  const hn::Rebind<std::uint8_t, D> d8;
  const auto mark = [&](Known as) HWY_ATTR {
    const auto codes = hn::IfThenElseZero(found, hn::Set(di, static_cast<std::int32_t>(as)));
    hn::StoreU(hn::DemoteTo(d8, codes), d8, reinterpret_cast<std::uint8_t*>(known));
  };
  // One look at the cells around all places answers for nearly every vector.
  if (bicubic && knows_all(depths, least(x) - 1, least(y) - 1, most(x) + 3, most(y) + 3)) {
    mark(Known::Bicubic);
    return;
  }
  mark(Known::Bilinear);
  share_out(d, depths, i, reads);
  if (!bicubic) return;
  HWY_ALIGN std::int32_t column[kMostLanes], line[kMostLanes];
  hn::Store(x, di, column), hn::Store(y, di, line);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (known[k] != Known::Nothing && knows_sixteen(depths, column[k], line[k]))
      known[k] = Known::Bicubic;
  }
}

/// One vector of places.
template <class D>
HWY_INLINE HWY_ATTR void judge_at(D d, const ReadJob& job, const RowPlaces& places, std::size_t i,
                                  RowReads& reads) {
  const hn::RebindToSigned<D> di;
  const image::Plane<float>& depths = job.inverse_depth;
  const auto zero = hn::Zero(d);
  const auto width = hn::Set(d, static_cast<float>(depths.width()));
  const auto height = hn::Set(d, static_cast<float>(depths.height()));
  const auto stride = hn::Set(di, depths.width());
  const auto x = hn::LoadU(d, places.x.data() + i), y = hn::LoadU(d, places.y.data() + i);
  const auto expected = hn::LoadU(d, places.inverse_depth.data() + i);
  const auto inside =
      hn::And(hn::And(hn::Ge(x, zero), hn::Lt(x, width)),
              hn::And(hn::And(hn::Ge(y, zero), hn::Lt(y, height)), hn::Ge(expected, zero)));
  const auto cell = hn::Add(hn::Mul(hn::ConvertTo(di, hn::IfThenElseZero(inside, y)), stride),
                            hn::ConvertTo(di, hn::IfThenElseZero(inside, x)));
  hn::StoreU(cell, di, reads.within.data() + i);
  const auto there = hn::GatherIndex(d, depths.data(), cell);
  const auto slack = hn::Mul(hn::Set(d, job.tolerance), hn::Max(there, expected));
  const auto same = hn::And(
      inside, hn::And(hn::Ge(there, zero), hn::Le(hn::Abs(hn::Sub(there, expected)), slack)));
  const auto across = between(d, hn::IfThenElseZero(inside, x), depths.width());
  const auto down = between(d, hn::IfThenElseZero(inside, y), depths.height());
  const auto column = hn::ConvertTo(di, across.first), line = hn::ConvertTo(di, down.first);
  hn::StoreU(hn::Add(hn::Mul(line, stride), column), di, reads.first.data() + i);
  hn::StoreU(across.fraction, d, reads.across.data() + i);
  hn::StoreU(down.fraction, d, reads.down.data() + i);
  know(d, job, same, column, line, i, reads);
}

HWY_ATTR void judge_row(const ReadJob& job, const RowPlaces& places, RowReads& reads) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> d1;
  const std::size_t width = places.x.size(), lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= width; i += lanes) judge_at(d, job, places, i, reads);
  for (; i < width; ++i) judge_at(d1, job, places, i, reads);
}

// ---- what they show ----

using Four = hn::FixedTag<float, 4>;
using FourVec = hn::Vec<Four>;

HWY_INLINE HWY_ATTR FourVec load(const Texel* texel) {
  return hn::Load(Four(), &texel->r);
}

HWY_INLINE HWY_ATTR FourVec bilinear(const Texel* at, std::ptrdiff_t stride, const RowReads& reads,
                                     std::size_t i) {
  const Four d;
  auto sum = hn::Mul(hn::Set(d, reads.share[0][i]), load(at));
  sum = hn::MulAdd(hn::Set(d, reads.share[1][i]), load(at + 1), sum);
  sum = hn::MulAdd(hn::Set(d, reads.share[2][i]), load(at + stride), sum);
  return hn::MulAdd(hn::Set(d, reads.share[3][i]), load(at + stride + 1), sum);
}

/// Catmull-Rom weights of four cells around fractions in [0, 1), of as many places as a vector has
/// lanes; exact at 0.
struct CubicWeights {
  HWY_ALIGN float of[4 * HWY_MAX_BYTES / sizeof(float)];  ///< four by four

  HWY_INLINE HWY_ATTR void set(const float* fractions) {
    const hn::ScalableTag<float> d;
    const auto half = hn::Set(d, 0.5F);
    const auto t = hn::LoadU(d, fractions), t2 = hn::Mul(t, t), t3 = hn::Mul(t2, t);
    const auto w0 = hn::Mul(half, hn::Sub(hn::Sub(hn::Add(t2, t2), t3), t));
    const auto w3 = hn::Mul(half, hn::Sub(t3, t2));
    const auto w1 =
        hn::MulAdd(hn::Set(d, 1.5F), t3, hn::NegMulAdd(hn::Set(d, 2.5F), t2, hn::Set(d, 1.0F)));
    const auto w2 =
        hn::Mul(half, hn::NegMulAdd(hn::Set(d, 3.0F), t3, hn::MulAdd(hn::Set(d, 4.0F), t2, t)));
    hn::StoreInterleaved4(w0, w1, w2, w3, d, of);
  }
};

/// Of one, two or four cells side by side what join() makes of them.
template <class D, class Join>
HWY_INLINE HWY_ATTR FourVec joined(D d, hn::Vec<D> v, const Join& join) {
  if constexpr (hn::MaxLanes(d) > 4) {
    const hn::Half<D> half;
    return joined(half, join(hn::LowerHalf(half, v), hn::UpperHalf(half, v)), join);
  } else {
    return v;
  }
}

/// Which of four weights each number of the vectors of a row of four cells takes.
HWY_ALIGN constexpr std::int32_t kWeightOf[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/// `wx`, `wy`: four weights each.
HWY_INLINE HWY_ATTR FourVec bicubic(const Texel* first, std::ptrdiff_t stride, const float* wx,
                                    const float* wy) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(d)), kCells = kLanes / 4;
  const auto weights = hn::LoadDup128(d, wx);
  auto sum = hn::Zero(d);
  for (int part = 0; part < 4 / kCells; ++part) {
    const float* at = &(first - stride - 1 + part * kCells)->r;
    auto column = hn::Mul(hn::Set(d, wy[0]), hn::LoadU(d, at));
    for (int j = 1; j < 4; ++j) {
      column = hn::MulAdd(hn::Set(d, wy[j]), hn::LoadU(d, at + j * stride * 4), column);
    }
    const auto which = hn::IndicesFromVec(d, hn::LoadU(di, kWeightOf + part * kLanes));
    sum = hn::MulAdd(hn::TableLookupLanes(weights, which), column, sum);
  }
  const hn::CappedTag<float, 8> pair;
  auto low = hn::LoadU(pair, &first->r), high = low;
  for (int cell = static_cast<int>(hn::MaxLanes(pair)) / 4; cell < 4;
       cell += static_cast<int>(hn::MaxLanes(pair)) / 4) {
    const auto value = hn::LoadU(pair, &(first + (cell / 2) * stride + cell % 2)->r);
    low = hn::Min(low, value), high = hn::Max(high, value);
  }
  const auto add = [](auto a, auto b) HWY_ATTR { return hn::Add(a, b); };
  const auto least = [](auto a, auto b) HWY_ATTR { return hn::Min(a, b); };
  const auto most = [](auto a, auto b) HWY_ATTR { return hn::Max(a, b); };
  return hn::Min(hn::Max(joined(d, sum, add), joined(pair, low, least)), joined(pair, high, most));
}

HWY_INLINE HWY_ATTR void read_cells(const RowReads& reads, std::size_t begin, std::size_t end,
                                    const CubicWeights& x, const CubicWeights& y,
                                    const PictureRow& row) {
  const std::ptrdiff_t stride = row.picture.width();
  const Texel* picture = row.picture.data();
  for (std::size_t i = begin, k = 0; i < end; ++i, k += 4) {
    const Texel* first = picture + reads.first[i];
    if (reads.known[i] == Known::Bicubic) {
      hn::Store(bicubic(first, stride, x.of + k, y.of + k), Four(), &row.row[i].r);
    } else if (reads.known[i] == Known::Bilinear) {
      hn::Store(bilinear(first, stride, reads, i), Four(), &row.row[i].r);
    }
  }
}

HWY_ATTR void read_pictures(const RowReads& reads, std::span<const PictureRow> rows) {
  const std::size_t width = reads.known.size(), step = hn::Lanes(hn::ScalableTag<float>());
  CubicWeights x, y;
  for (std::size_t begin = 0; begin < width; begin += step) {
    const std::size_t end = std::min(begin + step, width);
    x.set(reads.across.data() + begin), y.set(reads.down.data() + begin);
    for (const PictureRow& row : rows) read_cells(reads, begin, end, x, y, row);
  }
}

/// Whole vectors of four are stored, so that each cell's last number is overwritten by the next
/// cell's first; the last cell goes by itself.
HWY_ATTR void show_cells(const Texel* color, const Texel* sampled, std::size_t width, Rgb* shown) {
  const Four d;
  for (std::size_t i = 0; i < width; ++i) {
    const auto root = load(color + i);
    auto sum = hn::Mul(root, root);
    if (sampled != nullptr) sum = hn::MulAdd(load(sampled + i), load(sampled + i), sum);
    if (i + 1 < width) {
      hn::StoreU(sum, d, &shown[i].x);
    } else {
      HWY_ALIGN float last[4];
      hn::Store(sum, d, last);
      shown[i] = {last[0], last[1], last[2]};
    }
  }
}

}  // namespace macula::reconstruction::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reconstruction {

/// Numbers in the widest vector of any instruction set.
constexpr std::size_t kWidestVector = 16;

HWY_EXPORT(judge_row);
HWY_EXPORT(read_pictures);
HWY_EXPORT(show_cells);

void RowReads::resize(std::size_t width) {
  known.resize(width);
  first.resize(width), within.resize(width);
  // Fractions are read a whole vector at a time.
  across.resize(width + kWidestVector), down.resize(width + kWidestVector);
  for (auto& of_cell : share) of_cell.resize(width);
}

void RowReads::copy(std::size_t i, const RowReads& from, std::size_t k) {
  known[i] = from.known[k];
  first[i] = from.first[k], within[i] = from.within[k];
  across[i] = from.across[k], down[i] = from.down[k];
  for (int cell = 0; cell < 4; ++cell) share[cell][i] = from.share[cell][k];
}

void judge_places(const ReadJob& job, const RowPlaces& places, RowReads& reads) {
  MACULA_CHECK(job.inverse_depth.width() > 1 && job.inverse_depth.height() > 1);
  reads.resize(places.x.size());
  HWY_DYNAMIC_DISPATCH(judge_row)(job, places, reads);
}

void read_row(const RowReads& reads, std::span<const PictureRow> rows) {
  for (const PictureRow& row : rows) MACULA_CHECK(row.row.size() == reads.known.size());
  HWY_DYNAMIC_DISPATCH(read_pictures)(reads, rows);
}

void show_row(std::span<const Texel> color, std::span<const Texel> sampled, std::span<Rgb> shown) {
  MACULA_CHECK(color.size() == shown.size() && (sampled.empty() || sampled.size() == color.size()));
  HWY_DYNAMIC_DISPATCH(show_cells)
  (color.data(), sampled.empty() ? nullptr : sampled.data(), color.size(), shown.data());
}

}  // namespace macula::reconstruction
#endif
