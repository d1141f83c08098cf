#include "server/scene/built_in/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shared/base/check.h"

namespace macula::scene::built_in {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

/// The vertices of one row: consecutive indices, ascending in u.
struct Row {
  Index first = 0;
  int count = 0;
};

/// Where the vertices of a row lie in u. Odd rows sit half a column further; on an open surface
/// they keep both end points as well.
std::vector<float> row_positions(const Tessellation& tessellation, bool staggered) {
  const float step = 1.0F / static_cast<float>(tessellation.columns);
  const float shift = staggered ? 0.5F : 0.0F;
  std::vector<float> positions;
  const bool open_ends = staggered && tessellation.around == Around::Open;
  if (open_ends) positions.push_back(0.0F);
  const int inner = open_ends ? tessellation.columns : tessellation.columns + 1;
  for (int i = 0; i < inner; ++i) positions.push_back((static_cast<float>(i) + shift) * step);
  if (open_ends) positions.push_back(1.0F);
  return positions;
}

Row add_row(Mesh& mesh, const Surface& surface, const Tessellation& tessellation, int row) {
  const float v = static_cast<float>(row) / static_cast<float>(tessellation.rows);
  Row result{static_cast<Index>(mesh.positions.size()), 0};
  for (const float u : row_positions(tessellation, row % 2 == 1)) {
    mesh.positions.push_back(surface(u, v));
    mesh.texcoords.push_back(Vec2{u, v} * tessellation.texcoord_scale);
    ++result.count;
  }
  return result;
}

void add_triangle(Mesh& mesh, Index a, Index b, Index c) {
  const Vec3& origin = mesh.positions[a];
  const Vec3 area = cross(mesh.positions[b] - origin, mesh.positions[c] - origin);
  if (dot(area, area) > 0.0F) mesh.triangles.emplace_back(a, b, c);
}

/// Zips two rows: always advances on the row whose next vertex comes first in u.
void add_strip(Mesh& mesh, const Row& below, const Row& above) {
  int i = 0, j = 0;
  const auto u_of = [&mesh](const Row& row, int k) { return mesh.texcoords[row.first + k].x; };
  while (i + 1 < below.count || j + 1 < above.count) {
    const bool advance_below =
        j + 1 >= above.count || (i + 1 < below.count && u_of(below, i + 1) <= u_of(above, j + 1));
    const Index a = below.first + i, b = above.first + j;
    if (advance_below) {
      add_triangle(mesh, a, a + 1, b);
      ++i;
    } else {
      add_triangle(mesh, a, b + 1, b);
      ++j;
    }
  }
}

void add_face_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3{0.0F});
  for (const UVec3& t : mesh.triangles) {
    const Vec3 area =
        cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    for (int corner = 0; corner < 3; ++corner) mesh.normals[t[corner]] += area;
  }
}

/// Vertices that share a place share a normal: both ends of a closed row, all of a pole.
void weld_row(Mesh& mesh, const Row& row, Around around) {
  const Index last = row.first + row.count - 1;
  const bool pole = mesh.positions[row.first] == mesh.positions[row.first + row.count / 2];
  if (pole) {
    Vec3 sum{0.0F};
    for (Index i = row.first; i <= last; ++i) sum += mesh.normals[i];
    for (Index i = row.first; i <= last; ++i) mesh.normals[i] = sum;
  } else if (around == Around::Closed) {
    mesh.normals[row.first] += mesh.normals[last];
    mesh.normals[last] = mesh.normals[row.first];
  }
}

void normalize_normals(Mesh& mesh) {
  for (Vec3& normal : mesh.normals) {
    const float length = glm::length(normal);
    normal = length > 0.0F ? normal / length : Vec3{0.0F, 1.0F, 0.0F};
  }
}

/// Any unit vector perpendicular to `direction`.
Vec3 perpendicular(const Vec3& direction) {
  const Vec3 helper = std::abs(direction.y) < 0.9F ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  return normalize(cross(helper, direction));
}

struct Station {
  Vec3 centre, side, up;
};

/// Frames along a polyline, each the last one turned as little as possible (parallel transport).
std::vector<Station> stations_along(std::span<const Vec3> path) {
  std::vector<Station> stations;
  Vec3 side{0.0F};
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3& before = path[i == 0 ? 0 : i - 1];
    const Vec3& after = path[std::min(i + 1, path.size() - 1)];
    const Vec3 tangent = normalize(after - before);
    side = i == 0 ? perpendicular(tangent) : normalize(side - tangent * dot(side, tangent));
    stations.push_back({path[i], side, cross(tangent, side)});
  }
  return stations;
}

}  // namespace

Mesh tessellate(std::string name, const Surface& surface, const Tessellation& tessellation) {
  MACULA_CHECK(tessellation.columns >= 1 && tessellation.rows >= 1);
  Mesh mesh;
  mesh.name = std::move(name);
  std::vector<Row> rows;
  // Rows are zipped by u itself, so texture coordinates are scaled only afterwards.
  Tessellation unit = tessellation;
  unit.texcoord_scale = Vec2{1.0F};
  for (int row = 0; row <= tessellation.rows; ++row) {
    rows.push_back(add_row(mesh, surface, unit, row));
    if (row > 0) add_strip(mesh, rows[row - 1], rows[row]);
  }
  add_face_normals(mesh);
  for (const Row& row : rows) weld_row(mesh, row, tessellation.around);
  normalize_normals(mesh);
  for (Vec2& texcoord : mesh.texcoords) texcoord *= tessellation.texcoord_scale;
  return mesh;
}

Mesh parallelogram(std::string name, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                   const Vec2& texcoord_scale) {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.positions = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
  mesh.normals.assign(4, normalize(cross(edge_u, edge_v)));
  for (const Vec2 uv : {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}}) {
    mesh.texcoords.push_back(uv * texcoord_scale);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh box(std::string name, const Vec3& size, float texture_size_m) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0F, -1.0F}) {
      Vec3 u{0.0F}, v{0.0F}, normal{0.0F};
      normal[axis] = sign;
      u[(axis + 1) % 3] = sign;
      v[(axis + 2) % 3] = 1.0F;
      const Vec3 corner = 0.5F * size * (normal - u - v);
      const Vec2 extent = Vec2{size[(axis + 1) % 3], size[(axis + 2) % 3]} / texture_size_m;
      append(mesh, parallelogram("", corner, u * size, v * size, extent));
    }
  }
  return mesh;
}

Mesh sphere(std::string name, float radius, int columns, int rows, const Vec2& texcoord_scale) {
  const auto surface = [radius](float u, float v) {
    const float azimuth = kTurn * u, polar = 0.5F * kTurn * v;
    // The poles are exact, so that their row collapses to one point.
    const float ring = v <= 0.0F || v >= 1.0F ? 0.0F : std::sin(polar);
    return radius * Vec3{ring * std::cos(azimuth), -std::cos(polar), -ring * std::sin(azimuth)};
  };
  return tessellate(std::move(name), surface, {columns, rows, Around::Closed, texcoord_scale});
}

Mesh torus(std::string name, float ring_radius, float tube_radius, int columns, int rows,
           const Vec2& texcoord_scale) {
  MACULA_CHECK(rows % 2 == 0, "an odd number of rows would not close a staggered torus");
  const auto surface = [=](float u, float v) {
    const float azimuth = kTurn * u, around = kTurn * v;
    const float ring = ring_radius + tube_radius * std::cos(around);
    return Vec3{ring * std::cos(azimuth), tube_radius * std::sin(around),
                -ring * std::sin(azimuth)};
  };
  Mesh mesh = tessellate(std::move(name), surface, {columns, rows, Around::Closed, texcoord_scale});
  // The last row lies on the first one, so they share normals too.
  const std::size_t row = static_cast<std::size_t>(columns) + 1;
  for (std::size_t i = 0; i < row; ++i) {
    Vec3& first = mesh.normals[i];
    Vec3& last = mesh.normals[mesh.normals.size() - row + i];
    first = last = normalize(first + last);
  }
  return mesh;
}

Mesh lathe(std::string name, std::span<const Vec2> profile, int columns,
           const Vec2& texcoord_scale) {
  MACULA_CHECK(profile.size() >= 2);
  const int rows = static_cast<int>(profile.size()) - 1;
  const auto surface = [profile, rows](float u, float v) {
    const Vec2& point =
        profile[static_cast<std::size_t>(std::lround(v * static_cast<float>(rows)))];
    return Vec3{point.x * std::cos(kTurn * u), point.y, -point.x * std::sin(kTurn * u)};
  };
  return tessellate(std::move(name), surface, {columns, rows, Around::Closed, texcoord_scale});
}

Mesh tube(std::string name, std::span<const Vec3> path, float radius, int columns,
          const Vec2& texcoord_scale) {
  MACULA_CHECK(path.size() >= 2);
  const std::vector<Station> stations = stations_along(path);
  const int rows = static_cast<int>(path.size()) - 1;
  const auto surface = [&stations, rows, radius](float u, float v) {
    const Station& s =
        stations[static_cast<std::size_t>(std::lround(v * static_cast<float>(rows)))];
    return s.centre + radius * (std::cos(kTurn * u) * s.side + std::sin(kTurn * u) * s.up);
  };
  return tessellate(std::move(name), surface, {columns, rows, Around::Closed, texcoord_scale});
}

void append(Mesh& mesh, const Mesh& piece, const DMat4& mesh_from_piece) {
  MACULA_CHECK(&mesh != &piece, "a mesh must not grow while it is copied from");
  const Index offset = static_cast<Index>(mesh.positions.size());
  const DMat3 turn(mesh_from_piece);
  for (const Vec3& position : piece.positions) {
    mesh.positions.emplace_back(Vec3(DVec3(mesh_from_piece * DVec4(DVec3(position), 1.0))));
  }
  for (const Vec3& normal : piece.normals) {
    mesh.normals.emplace_back(Vec3(normalize(turn * DVec3(normal))));
  }
  mesh.texcoords.insert(mesh.texcoords.end(), piece.texcoords.begin(), piece.texcoords.end());
  for (const UVec3& triangle : piece.triangles) mesh.triangles.push_back(triangle + UVec3(offset));
}

Mesh inside_out(Mesh mesh) {
  for (UVec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
  for (Vec3& normal : mesh.normals) normal = -normal;
  return mesh;
}

std::vector<Vec2> smooth(std::span<const Vec2> points, int steps) {
  MACULA_CHECK(points.size() >= 2 && steps >= 1);
  const std::size_t last = points.size() - 1;
  std::vector<Vec2> result;
  for (std::size_t i = 0; i < last; ++i) {
    const Vec2 &p0 = points[i == 0 ? 0 : i - 1], &p1 = points[i], &p2 = points[i + 1];
    const Vec2& p3 = points[std::min(i + 2, last)];
    for (int step = 0; step < steps; ++step) {
      const float t = static_cast<float>(step) / static_cast<float>(steps);
      result.push_back(p1 + 0.5F * t *
                                ((p2 - p0) + t * ((2.0F * p0 - 5.0F * p1 + 4.0F * p2 - p3) +
                                                  t * (3.0F * (p1 - p2) + p3 - p0))));
    }
  }
  result.push_back(points[last]);
  return result;
}

}  // namespace macula::scene::built_in
