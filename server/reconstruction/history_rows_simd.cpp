#include "server/reconstruction/history_rows.h"
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
template <class D, class I>
HWY_INLINE HWY_ATTR void share_out(D d, const float* depths, std::ptrdiff_t stride, I first,
                                   hn::Vec<D> across, hn::Vec<D> down, std::size_t i,
                                   RowReads& reads) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const auto known = [&](std::ptrdiff_t offset) HWY_ATTR {
    return hn::IfThenElseZero(hn::Ge(hn::GatherIndex(d, depths + offset, first), zero), one);
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

/// One vector of places. `agrees`: 1 where what lies there is what was looked for, else 0.
template <class D>
HWY_INLINE HWY_ATTR void judge_at(D d, const ReadJob& job, const RowPlaces& places, std::size_t i,
                                  std::int32_t* agrees, RowReads& reads) {
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
  hn::StoreU(hn::IfThenElseZero(hn::RebindMask(di, same), hn::Set(di, 1)), di, agrees);
  const auto across = between(d, hn::IfThenElseZero(inside, x), depths.width());
  const auto down = between(d, hn::IfThenElseZero(inside, y), depths.height());
  const auto first =
      hn::Add(hn::Mul(hn::ConvertTo(di, down.first), stride), hn::ConvertTo(di, across.first));
  hn::StoreU(first, di, reads.first.data() + i);
  hn::StoreU(across.fraction, d, reads.across.data() + i);
  hn::StoreU(down.fraction, d, reads.down.data() + i);
  share_out(d, depths.data(), depths.width(), first, across.fraction, down.fraction, i, reads);
}

/// Whether all sixteen cells around a place are known.
HWY_INLINE HWY_ATTR bool knows_sixteen(const image::Plane<float>& depths, std::int32_t first) {
  const hn::FixedTag<float, 4> d;
  const int x = first % depths.width() - 1, y = first / depths.width() - 1;
  if (x < 0 || y < 0 || x + 4 > depths.width() || y + 4 > depths.height()) return false;
  const float* at = depths.data() + first - depths.width() - 1;
  auto least = hn::LoadU(d, at);
  for (int j = 1; j < 4; ++j) least = hn::Min(least, hn::LoadU(d, at + j * depths.width()));
  return hn::AllTrue(d, hn::Ge(least, hn::Zero(d)));
}

HWY_ATTR void judge_row(const ReadJob& job, const RowPlaces& places, RowReads& reads) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> d1;
  const std::size_t width = places.x.size(), lanes = hn::Lanes(d);
  HWY_ALIGN std::int32_t agrees[HWY_MAX_BYTES / sizeof(std::int32_t)];
  for (std::size_t i = 0; i < width;) {
    const std::size_t count = i + lanes <= width ? lanes : 1;
    if (count == lanes) {
      judge_at(d, job, places, i, agrees, reads);
    } else {
      judge_at(d1, job, places, i, agrees, reads);
    }
    for (std::size_t k = 0; k < count; ++k, ++i) {
      reads.known[i] = agrees[k] != 0 ? Known::Bilinear : Known::Nothing;
      if (agrees[k] == 0 || job.reading == Reading::Bilinear) continue;
      if (knows_sixteen(job.inverse_depth, reads.first[i])) reads.known[i] = Known::Bicubic;
    }
  }
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

/// Catmull-Rom weights of four cells around a fraction in [0, 1); exact at 0.
struct CubicWeights {
  float w[4];
  explicit CubicWeights(float t) {
    const float t2 = t * t, t3 = t2 * t;
    w[0] = 0.5F * (-t + 2.0F * t2 - t3), w[1] = 0.5F * (2.0F - 5.0F * t2 + 3.0F * t3);
    w[2] = 0.5F * (t + 4.0F * t2 - 3.0F * t3), w[3] = 0.5F * (t3 - t2);
  }
};

HWY_INLINE HWY_ATTR FourVec bicubic(const Texel* first, std::ptrdiff_t stride, float across,
                                    float down) {
  const Four d;
  const CubicWeights wx(across), wy(down);
  auto sum = hn::Zero(d);
  for (int j = 0; j < 4; ++j) {
    const Texel* at = first + (j - 1) * stride - 1;
    auto row = hn::Mul(hn::Set(d, wx.w[0]), load(at));
    for (int i = 1; i < 4; ++i) row = hn::MulAdd(hn::Set(d, wx.w[i]), load(at + i), row);
    sum = hn::MulAdd(hn::Set(d, wy.w[j]), row, sum);
  }
  const FourVec a = load(first), b = load(first + 1);
  const FourVec c = load(first + stride), e = load(first + stride + 1);
  const auto low = hn::Min(hn::Min(a, b), hn::Min(c, e));
  const auto high = hn::Max(hn::Max(a, b), hn::Max(c, e));
  return hn::Min(hn::Max(sum, low), high);
}

HWY_ATTR void read_cells(const RowReads& reads, const Texel* picture, std::ptrdiff_t stride,
                         Texel* row) {
  const Four d;
  for (std::size_t i = 0; i < reads.known.size(); ++i) {
    const Texel* first = picture + reads.first[i];
    if (reads.known[i] == Known::Bilinear) {
      hn::Store(bilinear(first, stride, reads, i), d, &row[i].r);
    } else if (reads.known[i] == Known::Bicubic) {
      hn::Store(bicubic(first, stride, reads.across[i], reads.down[i]), d, &row[i].r);
    }
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

HWY_EXPORT(judge_row);
HWY_EXPORT(read_cells);
HWY_EXPORT(show_cells);

void RowReads::resize(std::size_t width) {
  known.resize(width);
  first.resize(width), within.resize(width);
  across.resize(width), down.resize(width);
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

void read_row(const RowReads& reads, const image::Plane<Texel>& picture, std::span<Texel> row) {
  MACULA_CHECK(row.size() == reads.known.size());
  HWY_DYNAMIC_DISPATCH(read_cells)(reads, picture.data(), picture.width(), row.data());
}

void show_row(std::span<const Texel> color, std::span<const Texel> sampled, std::span<Rgb> shown) {
  MACULA_CHECK(color.size() == shown.size() && (sampled.empty() || sampled.size() == color.size()));
  HWY_DYNAMIC_DISPATCH(show_cells)
  (color.data(), sampled.empty() ? nullptr : sampled.data(), color.size(), shown.data());
}

}  // namespace macula::reconstruction
#endif
