#include "server/scene/built_in/city_building.h"

#include <cmath>
#include <numbers>
#include <span>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in::city {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

struct Opening {
  float half_width, bottom, top;
};
constexpr Opening kWindow{0.6F, 0.75F, 2.65F}, kShop{1.25F, 0.45F, 3.0F}, kDoor{0.65F, 0.0F, 2.9F};
constexpr float kReveal = 0.2F;  // m from the wall's face to the glass

void quad(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, const Vec2& repeat) {
  append(mesh, parallelogram("", corner, u, v, repeat));
}

/// A bay of wall around an opening and the opening's four sides; x in [-kBay / 2, kBay / 2], face
/// at z = 0, outwards +z. One picture covers a bay.
Mesh wall_with(const Opening& hole, float height) {
  Mesh mesh;
  const auto face = [&](float x0, float x1, float y0, float y1) {
    if (y1 <= y0) return;
    Mesh part = parallelogram("", {x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0});
    for (std::size_t i = 0; i < 4; ++i)
      part.texcoords[i] = {part.positions[i].x / kBay + 0.5F, -part.positions[i].y / kFloor};
    append(mesh, part);
  };
  const float w = hole.half_width, half = kBay / 2, rise = hole.top - hole.bottom;
  face(-half, -w, 0.0F, height);
  face(w, half, 0.0F, height);
  face(-w, w, 0.0F, hole.bottom);
  face(-w, w, hole.top, height);
  const Vec3 in{0, 0, -kReveal};
  quad(mesh, {-w, hole.bottom, 0}, in, {0, rise, 0}, {0.07F, 0.6F});
  quad(mesh, Vec3{w, hole.bottom, 0} + in, -in, {0, rise, 0}, {0.07F, 0.6F});
  quad(mesh, {-w, hole.top, 0}, in, {2 * w, 0, 0}, {0.07F, 0.4F});
  quad(mesh, Vec3{-w, hole.bottom, 0} + in, -in, {2 * w, 0, 0}, {0.07F, 0.4F});
  return mesh;
}

Mesh glass_of(const Opening& hole) {
  return parallelogram("", {-hole.half_width, hole.bottom, -kReveal}, {2 * hole.half_width, 0, 0},
                       {0, hole.top - hole.bottom, 0});
}

/// Bars around and across an opening.
Mesh frame_of(const Opening& hole, int panes_across, int panes_up) {
  Mesh mesh;
  constexpr float kThick = 0.06F, kBar = 0.03F;
  const float rise = hole.top - hole.bottom, width = 2 * hole.half_width;
  const double z = -kReveal + 0.03, middle = hole.bottom + rise / 2.0;
  for (int i = 0; i <= panes_across; ++i) {
    const float thick = i == 0 || i == panes_across ? kThick : kBar;
    append(mesh, box("", {thick, rise, 0.05F}),
           translation({width * (double(i) / panes_across - 0.5), middle, z}));
  }
  for (int i = 0; i <= panes_up; ++i) {
    const float thick = i == 0 || i == panes_up ? kThick : kBar;
    append(mesh, box("", {width, thick, 0.05F}),
           translation({0.0, hole.bottom + double{rise} * i / panes_up, z}));
  }
  return mesh;
}

/// An extruded profile (z, y) from bottom to top, centred on x = 0.
Mesh prism(std::span<const Vec2> profile, float length) {
  Mesh mesh;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Vec2 &low = profile[i - 1], step = profile[i] - low;
    quad(mesh, {-length / 2, low.y, low.x}, {length, 0, 0}, {0, step.y, step.x},
         Vec2{length, glm::length(step)});
  }
  return mesh;
}

Mesh window_hood() {
  constexpr std::array kProfile{Vec2{0.0F, 0.0F},   Vec2{0.06F, 0.02F}, Vec2{0.08F, 0.07F},
                                Vec2{0.16F, 0.09F}, Vec2{0.18F, 0.14F}, Vec2{0.0F, 0.20F}};
  Mesh mesh = prism(kProfile, 1.6F);
  // A shallow segment of an arch over it, fluted like a shell.
  const auto shell = [](float u, float v) {
    const float angle = kPi * (1.0F - u), r = 0.55F * v;
    const float flute = 0.05F * v * std::abs(std::sin(7.0F * angle));
    return Vec3{r * std::cos(angle), 0.12F + 0.5F * r * std::sin(angle), 0.03F + flute};
  };
  append(mesh, tessellate("", shell, {14, 2, Around::Open}));
  return mesh;
}

Mesh window_sill() {
  Mesh mesh = box("", {1.5F, 0.08F, 0.22F});
  for (Vec3& position : mesh.positions) position += Vec3{0.0F, 0.0F, 0.09F};
  // Two scrolled brackets carry it.
  const auto bracket = [](float u, float v) {
    const float depth = 0.02F + 0.12F * v * v + 0.02F * std::sin(2 * kPi * v);
    return Vec3{0.12F * (u - 0.5F), -0.3F * (1.0F - v) - 0.04F,
                depth * (1.0F - 2.0F * std::abs(u - 0.5F)) + 0.01F};
  };
  const Mesh scroll = tessellate("", bracket, {4, 5, Around::Open});
  for (const double x : {-0.55, 0.55}) append(mesh, scroll, translation({x, 0.0, 0.0}));
  return mesh;
}

Mesh eaves_cornice() {
  constexpr std::array kProfile{Vec2{0.0F, 0.0F},   Vec2{0.10F, 0.05F}, Vec2{0.12F, 0.16F},
                                Vec2{0.30F, 0.26F}, Vec2{0.34F, 0.36F}, Vec2{0.42F, 0.40F},
                                Vec2{0.42F, 0.50F}, Vec2{0.0F, 0.56F}};
  Mesh mesh = prism(kProfile, kBay);
  for (int i = 0; i < 8; ++i)
    append(mesh, box("", {0.14F, 0.13F, 0.12F}),
           translation({kBay * ((i + 0.5) / 8.0 - 0.5), 0.13, 0.16}));
  return mesh;
}

Mesh shutter_leaf() {
  constexpr float kWidth = 0.58F, kHeight = kWindow.top - kWindow.bottom;
  Mesh mesh;
  for (const float x : {0.03F, kWidth - 0.03F})
    append(mesh, box("", {0.06F, kHeight, 0.04F}), translation({double{x}, kHeight / 2.0, 0.0}));
  for (const float y : {0.04F, kHeight / 2, kHeight - 0.04F})
    append(mesh, box("", {kWidth - 0.12F, 0.08F, 0.04F}),
           translation({kWidth / 2.0, double{y}, 0.0}));
  const Mesh slat = parallelogram("", {-kWidth / 2 + 0.06F, -0.05F, 0.02F}, {kWidth - 0.12F, 0, 0},
                                  {0, 0.10F, -0.04F});
  constexpr int kSlats = 16;
  for (int i = 0; i < kSlats; ++i) {
    append(mesh, slat, translation({kWidth / 2.0, kHeight * (i + 0.5) / kSlats, 0.0}));
  }
  return mesh;
}

Mesh iron_balcony() {
  Mesh mesh = box("", {2.0F, 0.10F, 0.75F});
  for (Vec3& position : mesh.positions) position.z += 0.375F;
  constexpr std::array<Vec2, 5> kBaluster{Vec2{0.014F, 0.0F}, Vec2{0.03F, 0.25F},
                                          Vec2{0.012F, 0.45F}, Vec2{0.028F, 0.65F},
                                          Vec2{0.012F, 0.9F}};
  const Mesh bar = lathe("", kBaluster, 5);
  for (int i = 0; i < 11; ++i) append(mesh, bar, translation({-0.95 + 0.19 * i, 0.05, 0.70}));
  for (const double x : {-0.95, 0.95}) {
    for (int i = 0; i < 3; ++i) append(mesh, bar, translation({x, 0.05, 0.12 + 0.2 * i}));
  }
  append(mesh, box("", {2.0F, 0.05F, 0.07F}), translation({0.0, 0.97, 0.70}));
  for (const double x : {-0.95, 0.95})
    append(mesh, box("", {0.06F, 0.05F, 0.7F}), translation({x, 0.97, 0.35}));
  return mesh;
}

Mesh cloth_awning() {
  const auto surface = [](float u, float v) {
    const float out = 1.2F * v, sag = 0.12F * std::sin(kPi * v);
    const float scallop = v > 0.93F ? 0.10F * std::abs(std::sin(6.0F * kPi * u)) : 0.0F;
    return Vec3{2.7F * (u - 0.5F), -0.55F * v - sag - scallop, out};
  };
  return inside_out(tessellate("", surface, {36, 10, Around::Open, {3.0F, 1.0F}}));
}

Mesh wall_air_conditioner() {
  Mesh mesh = box("", {0.75F, 0.5F, 0.28F});
  for (Vec3& position : mesh.positions) position.z += 0.2F;
  append(mesh, torus("", 0.17F, 0.015F, 20, 6),
         translation({-0.1, 0.0, 0.35}) * rotation_x(Degrees{90.0}));
  for (int i = 0; i < 6; ++i)
    append(mesh, box("", {0.30F, 0.015F, 0.015F}),
           translation({-0.1, 0.0, 0.35}) * rotation_z(Degrees{30.0 * i}));
  return mesh;
}

Mesh roof_antenna() {
  const std::array mast{Vec3{0, 0, 0}, Vec3{0, 1.0F, 0}, Vec3{0, 2.2F, 0}};
  Mesh mesh = tube("", mast, 0.02F, 6);
  for (int i = 0; i < 7; ++i) {
    const float half = 0.25F + 0.04F * static_cast<float>(i), z = 0.12F * static_cast<float>(i);
    const std::array rod{Vec3{-half, 2.1F, z}, Vec3{0, 2.1F, z}, Vec3{half, 2.1F, z}};
    append(mesh, tube("", rod, 0.006F, 4));
  }
  const std::array boom{Vec3{0, 2.1F, -0.1F}, Vec3{0, 2.1F, 0.4F}, Vec3{0, 2.1F, 0.8F}};
  append(mesh, tube("", boom, 0.01F, 5));
  return mesh;
}

Mesh water_tank() {
  constexpr std::array<Vec2, 7> kProfile{Vec2{0.0F, 0.9F}, Vec2{0.95F, 0.9F}, Vec2{1.0F, 1.0F},
                                         Vec2{1.0F, 2.4F}, Vec2{0.95F, 2.5F}, Vec2{0.4F, 2.9F},
                                         Vec2{0.0F, 3.1F}};
  Mesh mesh = lathe("", kProfile, 24);
  for (int i = 0; i < 4; ++i) {
    const float a = 0.5F * kPi * (static_cast<float>(i) + 0.5F);
    const float x = 0.8F * std::cos(a), z = 0.8F * std::sin(a);
    const std::array leg{Vec3{x, 0, z}, Vec3{x, 0.5F, z}, Vec3{x, 1.0F, z}};
    append(mesh, tube("", leg, 0.05F, 6));
  }
  return mesh;
}

Mesh drain() {
  std::vector<Vec3> path;
  for (int i = 0; i <= 4; ++i) path.emplace_back(0.0F, kFloor * static_cast<float>(i) / 4.0F, 0.1F);
  Mesh mesh = tube("", path, 0.05F, 8);
  append(mesh, torus("", 0.055F, 0.02F, 10, 4), translation({0.0, 0.4, 0.1}));
  return mesh;
}

// ---- a house from the kit ----

class Mason {
 public:
  Mason(const Kit& kit, const Plan& plan) : kit_(kit), plan_(plan), dice_(plan.seed) {}

  House build() {
    const int bays[] = {plan_.bays_x, plan_.bays_z, plan_.bays_x, plan_.bays_z};
    for (int side = 0; side < 4; ++side) {
      const double distance = (side % 2 == 0 ? plan_.bays_z : plan_.bays_x) * double{kBay} / 2.0;
      facade(rotation_y(Degrees{90.0 * side}) * translation({0.0, 0.0, distance}), bays[side]);
    }
    if (plan_.roof == RoofKind::Tiled) {
      tiled_roof();
    } else {
      flat_roof();
    }
    return std::move(house_);
  }

 private:
  void add(Part part, const Mesh& piece, const DMat4& at) { append(house_[part], piece, at); }
  float top() const { return kGroundFloor + kFloor * static_cast<float>(plan_.floors); }

  void facade(const DMat4& frame, int bays) {
    const int door = dice_.below(bays);
    for (int bay = 0; bay < bays; ++bay) {
      const double x = kBay * (bay + 0.5 - bays / 2.0);
      ground_bay(frame * translation({x, 0.0, 0.0}), bay == door);
      for (int floor = 0; floor < plan_.floors; ++floor) {
        window_bay(frame * translation({x, kGroundFloor + double{kFloor} * floor, 0.0}));
      }
      add(Trim, kit_.cornice, frame * translation({x, top() - 0.05, 0.0}));
    }
    corner(frame * translation({-double{kBay} * bays / 2.0, 0.0, 0.0}));
  }
  void corner(const DMat4& at) {
    const int stones = static_cast<int>(top() / 0.4F);
    for (int i = 0; i < stones; ++i)
      add(Trim, kit_.quoin,
          at * translation({0.0, 0.4 * i + 0.2, 0.0}) *
              rotation_y(Degrees{i % 2 == 0 ? 0.0 : 90.0}));
    for (int floor = 0; floor <= plan_.floors; ++floor)
      add(Iron, kit_.drainpipe, at * translation({0.45, double{kFloor} * floor, 0.0}));
  }
  void ground_bay(const DMat4& at, bool door) {
    if (door) {
      add(Wall, kit_.door_wall, at);
      add(Trim, kit_.door, at * translation({0.0, 0.0, -kReveal + 0.02}));
    } else if (dice_.chance(plan_.shop_share)) {
      add(Wall, kit_.shop_wall, at);
      add(Frame, kit_.shop_frame, at);
      add(dice_.chance(0.25F) ? Blinds : Glass, kit_.shop_glass, at);
      if (dice_.chance(0.7F)) add(Cloth, kit_.awning, at * translation({0.0, 3.25, 0.02}));
    } else {
      const DMat4 lifted = at * translation({0.0, kGroundFloor - kFloor, 0.0});
      add(Wall, kit_.window_wall, lifted);
      add(Wall, base(), at);
      window(lifted);
    }
    add(Trim, kit_.string_course, at * translation({0.0, kGroundFloor - 0.1, 0.0}));
  }
  static Mesh base() {
    return parallelogram("", {-kBay / 2, 0, 0}, {kBay, 0, 0}, {0, kGroundFloor - kFloor, 0},
                         {1.0F, 0.19F});
  }
  void window_bay(const DMat4& at) {
    add(Wall, kit_.window_wall, at);
    window(at);
  }
  void window(const DMat4& at) {
    add(Frame, kit_.window_frame, at);
    add(dice_.chance(0.06F) ? Blinds : Glass, kit_.window_glass, at);
    add(Trim, kit_.hood, at * translation({0.0, kWindow.top + 0.08, 0.0}));
    if (dice_.chance(plan_.balcony_share)) {
      add(Iron, kit_.balcony, at * translation({0.0, kWindow.bottom - 0.1, 0.0}));
    } else {
      add(Trim, kit_.sill, at * translation({0.0, kWindow.bottom - 0.04, 0.0}));
      if (dice_.chance(0.12F)) add(Iron, kit_.air_conditioner, at * translation({0.0, 0.3, 0.0}));
    }
    if (plan_.shutters == Shutters::Louvred) shutters(at);
  }
  void shutters(const DMat4& at) {
    // From closed (0) to flat against the wall (180); most stand open.
    const double left = dice_.chance(0.15F) ? 10.0 * dice_.next() : 150.0 + 28.0 * dice_.next();
    const double right = dice_.chance(0.15F) ? 10.0 * dice_.next() : 150.0 + 28.0 * dice_.next();
    add(Shutter, kit_.shutter,
        at * translation({-kWindow.half_width, kWindow.bottom, 0.03}) * rotation_y(Degrees{-left}));
    add(Shutter, kit_.shutter,
        at * translation({kWindow.half_width, kWindow.bottom, 0.03}) *
            rotation_y(Degrees{180.0 + right}));
  }

  /// Two slopes of pantiles along x over gables.
  void tiled_roof() {
    const float half_length = kBay * static_cast<float>(plan_.bays_x) / 2 + 0.35F;
    const float half_span = kBay * static_cast<float>(plan_.bays_z) / 2 + 0.5F;
    const float rise = 0.62F * half_span, eaves = top() + 0.38F;
    const int tiles = static_cast<int>(2.0F * half_length / 0.32F);
    const int courses = static_cast<int>(std::hypot(half_span, rise) / 0.42F);
    for (const double turn : {0.0, 180.0}) {
      const auto slope = [=](float u, float v) {
        // Tiles are waves across; each course lies on the one below.
        const float wave = 0.035F * std::sin(2 * kPi * static_cast<float>(tiles) * u);
        const float row = v * static_cast<float>(courses) / 2.0F;
        const float lap = 0.05F * (1.0F - (row - std::floor(row)));
        return Vec3{2.0F * half_length * (u - 0.5F), eaves + rise * v + wave + lap,
                    half_span * (1.0F - v)};
      };
      add(Roof, tessellate("", slope, {4 * tiles, courses, Around::Open, {8.0F, 4.0F}}),
          rotation_y(Degrees{turn}));
    }
    gables(half_span - 0.5F, rise * (half_span - 0.5F) / half_span, eaves + 0.1F);
    chimneys(half_length, half_span, rise, eaves);
  }
  void gables(float half_span, float rise, float eaves) {
    Mesh gable;
    gable.positions = {{-half_span, eaves - 0.5F, 0},
                       {half_span, eaves - 0.5F, 0},
                       {half_span, eaves, 0},
                       {0, eaves + rise, 0},
                       {-half_span, eaves, 0}};
    gable.normals.assign(5, Vec3{0, 0, 1});
    for (const Vec3& p : gable.positions) gable.texcoords.emplace_back(p.x / kBay, -p.y / kFloor);
    gable.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    const double x = double{kBay} * plan_.bays_x / 2.0;
    for (const double turn : {90.0, -90.0})
      add(Wall, gable, rotation_y(Degrees{turn}) * translation({0.0, 0.0, x}));
  }
  void chimneys(float half_length, float half_span, float rise, float eaves) {
    const int count = 1 + dice_.below(3);
    for (int i = 0; i < count; ++i) {
      const double x = half_length * (1.6 * dice_.next() - 0.8), z = half_span * 0.3;
      add(Wall, box("", {0.7F, 2.2F, 0.7F}, 3.0F),
          translation({x, double{eaves} + 0.75 * rise + 0.6, z}));
      add(Trim, box("", {0.85F, 0.15F, 0.85F}), translation({x, eaves + 0.75 * rise + 1.75, z}));
    }
    add(Iron, kit_.antenna,
        translation({0.4 * half_length, double{eaves} + rise - 0.2, 0.0}) *
            rotation_y(Degrees{360.0 * dice_.next()}));
  }

  void flat_roof() {
    const float x = kBay * static_cast<float>(plan_.bays_x),
                z = kBay * static_cast<float>(plan_.bays_z);
    add(Roof, box("", {x, 0.2F, z}, 2.0F), translation({0.0, double{top()}, 0.0}));
    for (const double side : {-1.0, 1.0}) {
      add(Wall, box("", {x, 1.0F, 0.25F}, 3.0F),
          translation({0.0, top() + 0.9, side * (z / 2 - 0.12)}));
      add(Wall, box("", {0.25F, 1.0F, z - 0.5F}, 3.0F),
          translation({side * (x / 2 - 0.12), top() + 0.9, 0.0}));
    }
    const auto somewhere = [&] {
      return translation({(x - 3.0) * (dice_.next() - 0.5), top() + 0.1,
                          (z - 3.0) * (dice_.next() - 0.5)}) *
             rotation_y(Degrees{360.0 * dice_.next()});
    };
    add(Iron, kit_.tank, somewhere());
    for (int i = 0; i < 3; ++i) add(Iron, kit_.antenna, somewhere());
    for (int i = 0; i < 5; ++i)
      add(Iron, kit_.air_conditioner,
          somewhere() * translation({0.0, 0.3, 0.0}) * scaling(DVec3{1.8}));
  }

  const Kit& kit_;
  const Plan& plan_;
  Dice dice_;
  House house_;
};

}  // namespace

Kit make_kit() {
  Kit kit;
  kit.window_wall = wall_with(kWindow, kFloor);
  kit.shop_wall = wall_with(kShop, kGroundFloor);
  kit.door_wall = wall_with(kDoor, kGroundFloor);
  kit.window_frame = frame_of(kWindow, 2, 3);
  kit.shop_frame = frame_of(kShop, 3, 2);
  kit.window_glass = glass_of(kWindow);
  kit.shop_glass = glass_of(kShop);
  kit.hood = window_hood();
  kit.sill = window_sill();
  constexpr std::array kCourse{Vec2{0.0F, 0.0F}, Vec2{0.08F, 0.03F}, Vec2{0.10F, 0.14F},
                               Vec2{0.0F, 0.20F}};
  kit.string_course = prism(kCourse, kBay);
  kit.cornice = eaves_cornice();
  kit.quoin = box("", {0.5F, 0.36F, 0.30F});
  kit.door = box("", {1.3F, 2.9F, 0.06F});
  for (Vec3& position : kit.door.positions) position.y += 1.45F;
  for (int i = 0; i < 6; ++i)
    append(kit.door, box("", {0.45F, 0.75F, 0.05F}),
           translation({i % 2 == 0 ? -0.3 : 0.3, 0.55 + 0.9 * (i / 2), 0.03}));
  kit.shutter = shutter_leaf();
  kit.balcony = iron_balcony();
  kit.drainpipe = drain();
  kit.air_conditioner = wall_air_conditioner();
  kit.antenna = roof_antenna();
  kit.tank = water_tank();
  kit.awning = cloth_awning();
  return kit;
}

Plan draw_plan(Dice& dice) {
  Plan plan;
  plan.bays_x = 4 + dice.below(3);
  plan.bays_z = 3 + dice.below(3);
  plan.floors = 3 + dice.below(4);
  plan.roof = dice.chance(0.65F) ? RoofKind::Tiled : RoofKind::Flat;
  plan.shutters = dice.chance(0.5F) ? Shutters::Louvred : Shutters::None;
  plan.balcony_share = dice.chance(0.5F) ? dice.in(0.1F, 0.4F) : 0.03F;
  plan.shop_share = dice.in(0.1F, 0.8F);
  plan.seed = static_cast<std::uint64_t>(dice.below(1 << 24));
  return plan;
}

House make_house(const Kit& kit, const Plan& plan) {
  House house = Mason(kit, plan).build();
  constexpr std::array kNames{"wall",     "trim", "frames", "glass",  "blinds",
                              "shutters", "roof", "iron",   "awnings"};
  for (std::size_t i = 0; i < kParts; ++i) house[i].name = kNames[i];
  return house;
}

}  // namespace macula::scene::built_in::city
