// The shaders of WarpPass, stage by stage what client/reprojection does on the CPU: mesh.cpp
// (project), cuts.cpp (joints, quarters), holes.cpp (fills), resolve_simd.cpp (filters). Internal
// to this room.
#pragma once

namespace macula::display {

/// One point a cell of the mesh; the geometry shader draws it.
inline constexpr const char* kCellShader = R"(#version 330 core
uniform ivec2 cells;  // of the mesh: one more than of the grid along each axis
flat out ivec2 cell;
void main() {
  cell = ivec2(gl_VertexID % cells.x, gl_VertexID / cells.x);
  gl_Position = vec4(0.0);
}
)";

/// A whole cell as two triangles, a cut one as four quarters; nothing that is not in front.
inline constexpr const char* kQuadShader = R"(#version 330 core
layout(points) in;
layout(triangle_strip, max_vertices = 24) out;
uniform sampler2D inverse_depths;   // of the grid's cells, 1/m
uniform sampler2D wanted;           // of the mesh's cells; above 0: to be drawn
uniform samplerBuffer x_tangents, y_tangents;  // of the mesh's vertices
uniform vec3 from_x, from_y, from_forward, offset_m;
uniform vec2 pixels_per_tangent, first_pixel, size_px;
uniform float harmless;             // difference of inverse depth that needs no cut, 1/m
uniform bool cuts, splats, all_wanted;
uniform float layer_row;
flat in ivec2 cell[];
noperspective out vec3 place;       // u, v, inverse depth

struct Vertex { vec2 pixel; vec3 place; bool seen; };

float depth_at(ivec2 vertex) {
  ivec2 size = textureSize(inverse_depths, 0);
  float value = texelFetch(inverse_depths, clamp(vertex - 1, ivec2(0), size - 1), 0).r;
  if (!(value > 0.0) || isinf(value)) return 0.0;
  return min(value, 1000.0);
}
float x_at(int i) { return texelFetch(x_tangents, i).r; }
float y_at(int i) { return texelFetch(y_tangents, i).r; }

Vertex project(vec2 tangent, float inverse, vec2 uv) {
  vec3 direction = from_forward + tangent.y * from_y + tangent.x * from_x + inverse * offset_m;
  float forward = -direction.z;
  Vertex v;
  v.seen = forward > 1e-3 && forward > 0.01 * inverse;
  float scale = 1.0 / forward;
  v.pixel = vec2(direction.x, -direction.y) * scale * pixels_per_tangent + first_pixel;
  v.place = vec3(uv + vec2(0.0, layer_row), inverse * scale);
  return v;
}

void emit(Vertex v) {
  place = v.place;
  gl_Position = vec4((v.pixel + 0.5) / size_px * 2.0 - 1.0, 0.0, 1.0);
  EmitVertex();
}
void draw_triangle(Vertex a, Vertex b, Vertex c) {
  if (!(a.seen && b.seen && c.seen)) return;
  vec2 ab = b.pixel - a.pixel, ac = c.pixel - a.pixel;
  if (!(ab.x * ac.y - ac.x * ab.y > 1e-8)) return;  // from behind
  emit(a); emit(b); emit(c);
  EndPrimitive();
}
void draw_quad(Vertex ul, Vertex ur, Vertex ll, Vertex lr) {
  draw_triangle(ul, ur, ll);
  draw_triangle(lr, ll, ur);
}

// The step between the middle two of four in a line continues the slope before or after it, or
// lies between both.
bool is_planar(vec4 at, vec4 inverse) {
  float step = inverse.z - inverse.y, width = at.z - at.y;
  float before = at.y > at.x ? (inverse.y - inverse.x) / (at.y - at.x) * width : 0.0;
  float after = at.w > at.z ? (inverse.w - inverse.z) / (at.w - at.z) * width : 0.0;
  return step >= min(before, after) - harmless && step <= max(before, after) + harmless;
}
bool joined(ivec2 vertex, ivec2 along) {
  ivec2 last = textureSize(inverse_depths, 0) + 1;
  float a = depth_at(vertex), b = depth_at(vertex + along);
  if (abs(a - b) < harmless) return true;
  ivec2 before = max(vertex - along, ivec2(0)), after = min(vertex + 2 * along, last);
  vec4 inverse = vec4(depth_at(before), a, b, depth_at(after));
  vec4 at = along.x == 1
      ? vec4(x_at(before.x), x_at(vertex.x), x_at(vertex.x + 1), x_at(after.x))
      : vec4(y_at(before.y), y_at(vertex.y), y_at(vertex.y + 1), y_at(after.y));
  return is_planar(at, inverse);
}

void main() {
  ivec2 at = cell[0];
  if (!all_wanted && texelFetch(wanted, at, 0).r == 0.0) return;
  vec2 xs = vec2(x_at(at.x), x_at(at.x + 1)), ys = vec2(y_at(at.y), y_at(at.y + 1));
  float inverse[4];
  for (int i = 0; i < 4; ++i) inverse[i] = depth_at(at + ivec2(i & 1, i >> 1));
  vec2 first_uv = vec2(at) - 1.0;
  float least = min(min(inverse[0], inverse[1]), min(inverse[2], inverse[3]));
  float most = max(max(inverse[0], inverse[1]), max(inverse[2], inverse[3]));
  bool joint[4] = bool[4](true, true, true, true);  // upper, lower, left, right side
  if (cuts && most - least >= harmless) {
    joint[0] = joined(at, ivec2(1, 0));
    joint[1] = joined(at + ivec2(0, 1), ivec2(1, 0));
    joint[2] = joined(at, ivec2(0, 1));
    joint[3] = joined(at + ivec2(1, 0), ivec2(0, 1));
  }
  if (joint[0] && joint[1] && joint[2] && joint[3]) {
    Vertex v[4];
    for (int i = 0; i < 4; ++i) {
      vec2 share = vec2(i & 1, i >> 1);
      v[i] = project(vec2(xs[i & 1], ys[i >> 1]), inverse[i], first_uv + share);
    }
    draw_quad(v[0], v[1], v[2], v[3]);
    return;
  }
  if (!splats) return;
  for (int corner = 0; corner < 4; ++corner) {
    // Sets of corners, one bit each.
    int self = 1 << corner;
    int sideways = joint[corner >> 1] ? self | 1 << (corner ^ 1) : self;
    int upright = joint[2 + (corner & 1)] ? self | 1 << (corner ^ 2) : self;
    int component = self;
    for (int round = 0; round < 3; ++round) {
      for (int i = 0; i < 4; ++i) {
        if ((component >> i & 1) == 0) continue;
        if (joint[i >> 1]) component |= 1 << (i ^ 1);
        if (joint[2 + (i & 1)]) component |= 1 << (i ^ 2);
      }
    }
    int members[4] = int[4](self, sideways, upright, component);
    Vertex v[4];
    for (int i = 0; i < 4; ++i) {
      float sum = 0.0, count = 0.0;
      vec2 uv = vec2(0.0);
      for (int k = 0; k < 4; ++k) {
        if ((members[i] >> k & 1) == 0) continue;
        sum += inverse[k], count += 1.0;
        uv += vec2(k & 1, k >> 1);
      }
      vec2 share = vec2((i & 1) != 0 ? 0.5 : float(corner & 1), (i & 2) != 0 ? 0.5 : float(corner >> 1));
      v[i] = project(mix(vec2(xs.x, ys.x), vec2(xs.y, ys.y), share), sum / count,
                     first_uv + uv / count);
    }
    draw_quad(v[corner], v[corner ^ 1], v[corner ^ 2], v[corner ^ 3]);
  }
}
)";

/// Where a pixel's colour comes from; the nearest surface wins.
inline constexpr const char* kPlaceShader = R"(#version 330 core
noperspective in vec3 place;
out vec4 found;  // u, v, inverse depth, 1
void main() {
  float inverse = max(place.z, 0.0);
  found = vec4(place.xy, inverse, 1.0);
  gl_FragDepth = max(inverse * 1e-3, 1e-12);  // infinity, too, lies before what is cleared
}
)";

/// Covers the viewport.
inline constexpr const char* kWholeShader = R"(#version 330 core
void main() {
  gl_Position = vec4(4.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}
)";

/// Places -> colours; holes from the farther side. Alpha: 1 covered, 1/2 filled, 0 outside.
inline constexpr const char* kResolveShader = R"(#version 330 core
uniform sampler2D places, seen, hidden;
uniform vec4 fine;        // least and most u, least and most v, of cells that take Catmull-Rom
uniform float layer_row;  // rows from here on are the second layer's
uniform bool fills;
out vec4 color;

vec4 place_at(ivec2 p) { return texelFetch(places, p, 0); }
bool drawn(ivec2 p) { return place_at(p).a > 0.5; }

vec3 source(bool second, ivec2 cell) {
  ivec2 at = clamp(cell, ivec2(0), textureSize(seen, 0) - 1);
  return second ? texelFetch(hidden, at, 0).rgb : texelFetch(seen, at, 0).rgb;
}
vec4 catmull_rom(float t) {
  float t2 = t * t, t3 = t2 * t;
  return 0.5 * vec4(2.0 * t2 - t3 - t, 3.0 * t3 - 5.0 * t2 + 2.0, 4.0 * t2 - 3.0 * t3 + t, t3 - t2);
}
vec3 resolve(vec4 place) {
  vec2 size = vec2(textureSize(seen, 0));
  bool second = place.y >= layer_row - 1.0;
  vec2 uv = place.xy - vec2(0.0, second ? layer_row : 0.0);
  bool is_fine = uv.x >= fine.x && uv.x <= fine.y && uv.y >= fine.z && uv.y <= fine.w;
  vec2 within = clamp(uv, vec2(0.0), size - 1.0);
  ivec2 cell = min(ivec2(within), max(ivec2(size) - 2, ivec2(0)));
  vec2 beyond = within - vec2(cell);
  vec4 across = is_fine ? catmull_rom(beyond.x) : vec4(0.0, 1.0 - beyond.x, beyond.x, 0.0);
  vec4 down = is_fine ? catmull_rom(beyond.y) : vec4(0.0, 1.0 - beyond.y, beyond.y, 0.0);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      sum += down[j] * across[i] * source(second, cell + ivec2(i - 1, j - 1));
    }
  }
  return floor(clamp(sum, 0.0, 1.0) * 255.0 + 0.5) / 255.0;
}

// The nearest drawn pixel from p along a step; itself where there is none.
ivec2 nearest(ivec2 p, ivec2 step, ivec2 size) {
  for (ivec2 q = p + step; all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, size)); q += step) {
    if (drawn(q)) return q;
  }
  return p;
}
// The pixel behind the border one, where that is the same surface.
ivec2 offered(ivec2 border, ivec2 step, ivec2 size) {
  ivec2 p = border + step;
  if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, size)) || !drawn(p)) return border;
  float at_border = place_at(border).z;
  return abs(place_at(p).z - at_border) <= 0.05 * at_border ? p : border;
}
ivec2 farther(ivec2 one, ivec2 one_step, ivec2 other, ivec2 other_step, ivec2 size) {
  ivec2 a = offered(one, one_step, size), b = offered(other, other_step, size);
  return place_at(a).z <= place_at(b).z ? a : b;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), size = textureSize(places, 0);
  if (drawn(p)) {
    color = vec4(resolve(place_at(p)), 1.0);
    return;
  }
  ivec2 left = nearest(p, ivec2(-1, 0), size), right = nearest(p, ivec2(1, 0), size);
  ivec2 upper = nearest(p, ivec2(0, -1), size), lower = nearest(p, ivec2(0, 1), size);
  bool sideways = left != p && right != p, upright = upper != p && lower != p;
  color = vec4(0.0);
  if (!sideways && !upright) return;
  color.a = 0.5;
  if (!fills) return;
  ivec2 from = sideways && (!upright || right.x - left.x <= lower.y - upper.y)
                   ? farther(left, ivec2(-1, 0), right, ivec2(1, 0), size)
                   : farther(upper, ivec2(0, -1), lower, ivec2(0, 1), size);
  color.rgb = resolve(place_at(from));
}
)";

}  // namespace macula::display
