// Triangle meshes of simple things, in meters, counter-clockwise seen from outside, with unit
// normals and texture coordinates. Tessellations stagger every other row by half a column, so that
// curved surfaces have no planar quads: their triangles are as honest as scanned ones.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "server/scene/scene.h"

namespace macula::scene::built_in {

/// A surface over u, v in [0, 1]; its front is where d/du x d/dv points. A closed surface is asked
/// for u up to 1 + 0.5 / columns and must repeat with period 1.
using Surface = std::function<Vec3(float u, float v)>;
enum class Around { Open, Closed };
struct Tessellation {
  int columns = 16, rows = 16;
  Around around = Around::Open;
  Vec2 texcoord_scale{1.0F};  ///< texture coordinates are (u, v) times this
};
/// Smooth normals; triangles without area (poles) are left out.
Mesh tessellate(std::string name, const Surface& surface, const Tessellation& tessellation);

/// The parallelogram `corner`, corner + edge_u, corner + edge_u + edge_v, corner + edge_v.
Mesh parallelogram(std::string name, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                   const Vec2& texcoord_scale = Vec2{1.0F});
/// Centred on the origin; texture coordinates in meters / texture_size_m on every face.
Mesh box(std::string name, const Vec3& size, float texture_size_m = 1.0F);
Mesh sphere(std::string name, float radius, int columns, int rows,
            const Vec2& texcoord_scale = Vec2{1.0F});
/// About the Y axis in the XZ plane.
Mesh torus(std::string name, float ring_radius, float tube_radius, int columns, int rows,
           const Vec2& texcoord_scale = Vec2{1.0F});
/// A profile (radius, height), from bottom to top, turned about the Y axis; piecewise linear.
Mesh lathe(std::string name, std::span<const Vec2> profile, int columns,
           const Vec2& texcoord_scale = Vec2{1.0F});
/// A round tube along a polyline without reversals; open at its ends.
Mesh tube(std::string name, std::span<const Vec3> path, float radius, int columns,
          const Vec2& texcoord_scale = Vec2{1.0F});

/// Appends `piece`, moved by a rigid or uniformly scaled transform, to `mesh`. Both or neither have
/// texture coordinates.
void append(Mesh& mesh, const Mesh& piece, const DMat4& mesh_from_piece = DMat4{1.0});
/// The same triangles seen from the other side.
Mesh inside_out(Mesh mesh);
/// Catmull-Rom through the points, `steps` segments between two of them; for profiles and paths.
std::vector<Vec2> smooth(std::span<const Vec2> points, int steps);

}  // namespace macula::scene::built_in
