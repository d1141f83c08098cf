#include "client/reprojection/warp.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "client/reprojection/cuts.h"
#include "client/reprojection/doubled_colors.h"
#include "client/reprojection/holes.h"
#include "client/reprojection/raster_rules.h"
#include "client/reprojection/resolve.h"

namespace macula::reprojection {
namespace {

/// A patch of the mesh as the first look leaves it.
struct PatchPlace {
  int column, row, columns, rows;
  RowRange pixel_rows;
  bool flat;  ///< `shape` is all there is to draw
  BlockShape shape;
};

/// Which of a mesh's cells are to be drawn: 1 each, by the vertex at their upper left; null: all.
class WantedCells {
 public:
  explicit WantedCells(const image::Plane<std::uint8_t>* cells) : cells_(cells) {}

  bool any(int column, int row, int columns, int rows) const {
    for (int y = row; cells_ != nullptr && y < row + rows; ++y) {
      const auto some = cells_->row(y).subspan(static_cast<std::size_t>(column),
                                               static_cast<std::size_t>(columns));
      if (std::find(some.begin(), some.end(), std::uint8_t{1}) != some.end()) return true;
    }
    return cells_ == nullptr;
  }
  /// Of `columns` cells from (column, row) on.
  CellBits bits(int column, int row, int columns) const {
    if (cells_ == nullptr) return ~CellBits{0};
    CellBits bits = 0;
    for (int i = 0; i < columns; ++i) bits |= CellBits{(*cells_)(column + i, row)} << i;
    return bits;
  }

 private:
  const image::Plane<std::uint8_t>* cells_;
};

/// One layer's mesh, patch by patch: flat blocks as one, the rest cell by cell. Patches are looked
/// at once, and again with each band of the display that those which are not flat reach.
class MeshDrawing {
 public:
  MeshDrawing(const MeshProjector& mesh, const Cuts& cuts, const WarpOptions& options,
              const WantedCells& wanted, std::vector<PatchPlace>& places, Patch& patch)
      : mesh_(mesh),
        cuts_(cuts),
        options_(options),
        wanted_(wanted),
        flat_difference_(options.detail_px > 0.0F ? cuts.difference_of(options.detail_px) : -1.0F),
        places_(places),
        patch_(patch) {
    find_places();
  }

  void draw(Fragments& out) {
    band_ = {static_cast<float>(out.first_row()), static_cast<float>(out.end_row() - 1)};
    for (const PatchPlace& place : places_) {
      if (!is_in_band(place.pixel_rows)) continue;
      if (place.flat) {
        draw_block(place.shape, options_.detail_px, out);
      } else {
        mesh_.load(place.column, place.row, place.columns, place.rows, patch_);
        project_patch(mesh_.projection(), patch_);
        is_split_ = place.pixel_rows.first < band_.first || place.pixel_rows.last > band_.last;
        if (is_split_) pixel_rows(patch_, vertex_rows_);
        draw_patch(out);
      }
    }
  }

 private:
  static constexpr int kSmallestBlock = 4;  ///< cells a side

  /// How many cells a patch takes that begins at vertex `first` of `vertices`. The first and the
  /// last column and row are half a cell wide: patches of their own.
  static int cells_from(int first, int vertices) {
    const int last_inner = vertices - 2;  // the vertex before the outer edge
    return first == 0 || first == last_inner ? 1 : std::min(Patch::kCells, last_inner - first);
  }

  void find_places() {
    places_.clear();
    for (int row = 0; row + 1 < mesh_.rows(); row += patch_.rows) {
      const int rows = cells_from(row, mesh_.rows());
      for (int column = 0; column + 1 < mesh_.columns(); column += patch_.columns) {
        const int columns = cells_from(column, mesh_.columns());
        patch_.columns = columns, patch_.rows = rows;
        if (!wanted_.any(column, row, columns, rows)) continue;
        mesh_.load(column, row, columns, rows, patch_);
        places_.push_back(place_of_patch());
      }
    }
  }

  PatchPlace place_of_patch() {
    const Block whole{0, 0, patch_.columns, patch_.rows};
    PatchPlace place{patch_.column, patch_.row, patch_.columns, patch_.rows, {}, false, {}};
    place.flat = is_flat(patch_, whole, flat_difference_);
    if (place.flat) {
      place.shape = shape_of(patch_, whole);
      place.pixel_rows = grown(place.shape.pixel_rows());
    } else {
      project_patch(mesh_.projection(), patch_);
      pixel_rows(patch_, vertex_rows_);
      place.pixel_rows = reach(0, patch_.rows);
    }
    return place;
  }

  /// With what triangles grow by, and a pixel.
  RowRange grown(const RowRange& rows) const {
    const float grow_px = kGrow * (rows.last - rows.first) + 1.0F + options_.detail_px;
    return {rows.first - grow_px, rows.last + grow_px};
  }
  /// Pixel rows that the patch's cells of rows [row, row + rows) may draw to: those of their
  /// vertices, and half a cell beyond, where a cut cell's quarter ends at its own depth.
  RowRange reach(int row, int rows) const {
    RowRange all = vertex_rows_[row];
    for (int i = row + 1; i <= row + rows; ++i) {
      all.first = std::min(all.first, vertex_rows_[i].first);
      all.last = std::max(all.last, vertex_rows_[i].last);
    }
    const auto& y = patch_.y_tangents;
    const float tallest = std::max(y[row + 1] - y[row], y[row + rows] - y[row + rows - 1]);
    const float beyond_px = tallest * mesh_.projection().pixels_per_tangent.y;
    return grown({all.first - beyond_px, all.last + beyond_px});
  }
  bool is_in_band(const RowRange& rows) const {
    return rows.first <= band_.last && rows.last >= band_.first;
  }
  /// Whether the patch's cells of these rows reach the band.
  bool may_be_drawn(int row, int rows) const { return !is_split_ || is_in_band(reach(row, rows)); }

  void draw_patch(Fragments& out) {
    single_.fill(0);
    draw_halves({0, 0, patch_.columns, patch_.rows}, out);
    for (int row = 0; row < patch_.rows; ++row) {
      if (single_[row] != 0 && may_be_drawn(row, 1)) draw_singles(row, out);
    }
  }

  void draw_blocks(const Block& block, Fragments& out) {
    if (!wanted_.any(patch_.column + block.column, patch_.row + block.row, block.columns,
                     block.rows) ||
        !may_be_drawn(block.row, block.rows)) {
      return;
    }
    if (is_flat(patch_, block, flat_difference_)) {
      draw_block(shape_of(patch_, block), options_.detail_px, out);
    } else {
      draw_halves(block, out);
    }
  }

  void draw_halves(const Block& block, Fragments& out) {
    const int left = (block.columns + 1) / 2, upper = (block.rows + 1) / 2;
    const int right = block.columns - left, lower = block.rows - upper;
    if (std::max(left, upper) < kSmallestBlock || right == 0 || lower == 0) {
      const CellBits bits = static_cast<CellBits>((std::uint64_t{1} << block.columns) - 1);
      for (int row = 0; row < block.rows; ++row) single_[block.row + row] |= bits << block.column;
      return;
    }
    draw_blocks({block.column, block.row, left, upper}, out);
    draw_blocks({block.column + left, block.row, right, upper}, out);
    draw_blocks({block.column, block.row + upper, left, lower}, out);
    draw_blocks({block.column + left, block.row + upper, right, lower}, out);
  }

  void draw_singles(int row, Fragments& out) {
    CellBits whole = single_[row] & wanted_.bits(patch_.column, patch_.row + row, patch_.columns);
    CellBits steps = cells_with_steps(patch_, row, cuts_.harmless_difference()) & whole;
    for (; steps != 0; steps &= steps - 1) {
      const int column = std::countr_zero(steps);
      const int mesh_column = patch_.column + column, mesh_row = patch_.row + row;
      if (draw_cut_quad(mesh_, cuts_, mesh_column, mesh_row, options_.silhouettes, out)) {
        whole &= ~(CellBits{1} << column);
      }
    }
    CellBits large = draw_cells(patch_, row, whole, out);
    for (; large != 0; large &= large - 1) {
      draw_block(shape_of(patch_, {std::countr_zero(large), row, 1, 1}), 0.0F, out);
    }
  }

  const MeshProjector& mesh_;
  const Cuts& cuts_;
  const WarpOptions& options_;
  const WantedCells wanted_;
  const float flat_difference_;
  std::vector<PatchPlace>& places_;
  Patch& patch_;
  std::array<CellBits, Patch::kCells> single_{};
  VertexRows vertex_rows_{};  ///< of `patch_`
  RowRange band_{};           ///< that is drawn now
  bool is_split_ = false;     ///< the patch reaches beyond it
};

/// One layer with all that its drawing refers to.
class LayerDrawing {
 public:
  LayerDrawing(const SourceView& source, int layer_row, const WantedCells& wanted,
               const RelativeView& relative, const foveation::Display& display,
               const WarpOptions& options, std::vector<PatchPlace>& places, Patch& patch)
      : mesh_(source, relative, display, layer_row),
        cuts_(mesh_, relative, display, cut_px(options)),
        drawing_(mesh_, cuts_, options, wanted, places, patch) {}
  LayerDrawing(const LayerDrawing&) = delete;  // its parts refer to each other
  LayerDrawing& operator=(const LayerDrawing&) = delete;

  void draw(Fragments& out) { drawing_.draw(out); }

 private:
  static float cut_px(const WarpOptions& options) {
    const bool stretched = options.silhouettes == WarpOptions::Silhouettes::Stretch;
    return stretched ? std::numeric_limits<float>::infinity() : options.cut_px;
  }

  const MeshProjector mesh_;
  const Cuts cuts_;
  MeshDrawing drawing_;
};

/// The second layer as a picture of its own; nothing where none is known, none is wanted, or the
/// eye has not moved: what was hidden is hidden still.
std::optional<SourceView> hidden_source(const SourceView& source, const WarpOptions& options,
                                        const RelativeView& relative) {
  const bool wanted = options.layers == WarpOptions::Layers::Both && source.hidden != nullptr;
  if (!wanted || relative.offset_m == DVec3{0.0}) return std::nullopt;
  return SourceView{source.stage_from_view, source.grid, source.hidden->color,
                    source.hidden->inverse_depth_per_m};
}

/// Rows of a band: what is drawn there stays in a second-level cache of two megabytes, and most
/// patches lie within one. With a smaller cache a warp takes a few percent longer.
constexpr int kBandBytes = 1500'000;
int band_rows(int width) {
  return std::max(kBandBytes / (width * static_cast<int>(sizeof(Fragment))), 8);
}

/// Of the square that one fragment stands for.
int pixels_a_side(const foveation::Display& display, const WarpOptions& options) {
  const bool even = display.width_px % 2 == 0 && display.height_px % 2 == 0;
  return even && options.raster == WarpOptions::Raster::EverySecond ? 2 : 1;
}

/// Where one fragment stands for 2 x 2 pixels, cells that are wider have no detail between
/// fragments.
constexpr float kNarrow_px = 2.0F;

/// Lengths in fragments.
WarpOptions options_on_raster(WarpOptions options, int side_px) {
  options.detail_px /= static_cast<float>(side_px);
  options.cut_px /= static_cast<float>(side_px);
  return options;
}

void check_sizes(const SourceView& source, const foveation::Display& display) {
  const auto fits = [&](const auto& plane) {
    return plane.width() == source.grid.width() && plane.height() == source.grid.height();
  };
  MACULA_CHECK(foveation::is_valid(source.grid));
  MACULA_CHECK(fits(source.color) && fits(source.inverse_depth_per_m),
               "colour and depth must have the size of the grid");
  if (source.hidden != nullptr) {
    MACULA_CHECK(fits(source.hidden->color) && fits(source.hidden->inverse_depth_per_m));
    MACULA_CHECK(source.hidden->cells.width() == source.grid.width() + 1 &&
                 source.hidden->cells.height() == source.grid.height() + 1);
  }
  MACULA_CHECK(display.width_px > 0 && display.height_px > 0 && math::is_valid(display.fov));
}

}  // namespace

struct Warper::Memory {
  Patch patch;
  std::vector<PatchPlace> places, hidden_places;
  Fragments fragments;
  DoubledRows doubled;
  DoubledColors doubled_colors;
  FineRanges narrow;  ///< cells that pixels between fragments can tell apart
  Holes holes;
  int side_px = 1;  ///< of a fragment

  void resolve(const Resolver& resolver, int y, image::Plane<Rgb8>& out);
  void resolve_doubled(const Resolver& resolver, int y, std::span<Rgb8> out,
                       const FragmentSpan& exact);
};

/// The pixels of a row of fragments.
void Warper::Memory::resolve(const Resolver& resolver, int y, image::Plane<Rgb8>& out) {
  const FragmentRow row = fragments.row(y);
  if (side_px == 1) {
    resolver.resolve_row(row, 0, out.row(y));
    return;
  }
  const FragmentSpan exact = span_within(row, fragments.width(), narrow);
  for (const int pixel_row : {2 * y, 2 * y + 1}) {
    resolve_doubled(resolver, pixel_row, out.row(pixel_row), exact);
  }
}

/// A row of pixels: those of the fragments `exact` each from its own place in the source, the
/// others between fragments' colours.
void Warper::Memory::resolve_doubled(const Resolver& resolver, int y, std::span<Rgb8> out,
                                     const FragmentSpan& exact) {
  const auto [first, end] = exact;
  const auto smooth = [&](int from, int to) {
    if (from < to) doubled_colors.draw(fragments, resolver, y, from, to, out);
  };
  smooth(0, first);  // from left to right: it may write beyond
  if (first < end) {
    const auto begin_px = static_cast<std::size_t>(2 * first);
    resolver.resolve_row(doubled.row(fragments, y, first, end), 2 * first,
                         out.subspan(begin_px, static_cast<std::size_t>(2 * end) - begin_px));
  }
  smooth(end, fragments.width());
}

Warper::Warper() : memory_(std::make_unique<Memory>()) {}
Warper::~Warper() = default;
Warper::Warper(Warper&&) noexcept = default;
Warper& Warper::operator=(Warper&&) noexcept = default;

WarpReport Warper::warp(const SourceView& source, const Pose& stage_from_display,
                        const foveation::Display& display, const WarpOptions& options,
                        image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage) {
  check_sizes(source, display);
  const RelativeView relative =
      relative_view(source.stage_from_view, stage_from_display, options.method);
  auto& [patch, places, hidden_places, fragments, doubled, doubled_colors, narrow, holes, side_px] =
      *memory_;
  side_px = pixels_a_side(display, options);
  const foveation::Display raster{display.fov, display.width_px / side_px,
                                  display.height_px / side_px};
  const WarpOptions drawn = options_on_raster(options, side_px);
  LayerDrawing seen(source, 0, WantedCells(nullptr), relative, raster, drawn, places, patch);
  const auto hidden = hidden_source(source, options, relative);
  std::optional<LayerDrawing> behind;
  if (hidden) {
    behind.emplace(*hidden, kSecondLayerRow, WantedCells(&source.hidden->cells), relative, raster,
                   drawn, hidden_places, patch);
  }
  const Resolver resolver(source, display, options.filter);
  fragments.resize(raster.width_px, raster.height_px);
  if (side_px > 1) {
    doubled_colors.begin(raster.width_px);
    narrow = narrow_cells(source.grid, display, kNarrow_px);
  }
  holes.clear();
  if (out.width() != display.width_px || out.height() != display.height_px) {
    out.resize(display.width_px, display.height_px);
  }
  const int rows = band_rows(raster.width_px),
            beyond = side_px - 1;  // doubling looks at both sides
  for (int first = 0; first < raster.height_px; first += rows) {
    const int end = std::min(first + rows, raster.height_px);
    fragments.begin_band(std::max(first - beyond, 0), std::min(end + beyond, raster.height_px));
    if (behind) behind->draw(fragments);
    seen.draw(fragments);
    for (int y = first; y < end; ++y) {
      holes.note_row(fragments, y);
      memory_->resolve(resolver, y, out);
    }
  }
  const auto counts = holes.classify_and_fill(fragments, options.holes, side_px, out, coverage);
  const auto pixels =
      static_cast<std::uint64_t>(display.width_px) * static_cast<std::uint64_t>(display.height_px);
  return {pixels - counts.filled_px - counts.outside_px, counts.filled_px, counts.outside_px};
}

void Warper::copy_inverse_depth(image::Plane<float>& out) const {
  const auto& [fragments, side_px] = std::tie(memory_->fragments, memory_->side_px);
  const int width = side_px * fragments.width(), height = side_px * fragments.height();
  if (out.width() != width || out.height() != height) out.resize(width, height);
  for (int y = 0; y < height; ++y) {
    const float* const from = fragments.inverse_depths(y / side_px);
    const auto to = out.row(y);
    for (int x = 0; x < width; ++x) to[x] = std::max(from[x / side_px], 0.0F);
  }
}

WarpReport warp(const SourceView& source, const Pose& stage_from_display,
                const foveation::Display& display, const WarpOptions& options,
                image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage) {
  return Warper().warp(source, stage_from_display, display, options, out, coverage);
}

}  // namespace macula::reprojection
