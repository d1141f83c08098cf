// Patch: a small rectangle of the source mesh, near enough to stay in the first-level cache, as
// columns of floats that vectors read. Internal to this room.
#pragma once

#include <array>
#include <cstddef>

namespace macula::reprojection {

struct Patch {
  static constexpr int kCells = 31;           ///< at most, a side: 32 vertices are whole vectors
  static constexpr std::size_t kStride = 64;  ///< floats of a row; loads may run past the vertices
  static constexpr int kRows = kCells + 1;    ///< of vertices
  using Values = std::array<float, kStride * kRows>;

  int column = 0, row = 0;    ///< the mesh's vertex that the patch begins with
  int columns = 0, rows = 0;  ///< of cells; vertices are one more
  int layer_row = 0;          ///< added to v: which layer's colours are meant
  std::array<float, kStride> x_tangents{}, y_tangents{};  ///< of vertices; infinite past the last
  alignas(64) Values source_inverse{};                    ///< 1/m in source space, sound
  alignas(64) Values x{}, y{};         ///< display pixels; NaN: not in front of the eye
  alignas(64) Values inverse_depth{};  ///< 1/m in display space
  alignas(64) Values nearness{};       ///< source depth over display depth

  static std::size_t at(int vertex_column, int vertex_row) {
    return static_cast<std::size_t>(vertex_row) * kStride + static_cast<std::size_t>(vertex_column);
  }
};

}  // namespace macula::reprojection
