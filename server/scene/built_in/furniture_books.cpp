#include <cmath>
#include <numbers>

#include "server/scene/built_in/builder.h"
#include "server/scene/built_in/furniture.h"
#include "server/scene/built_in/random.h"
#include "server/scene/built_in/shapes.h"

namespace macula::scene::built_in {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

struct Volume {
  float thick, tall, deep;
};

/// Covers and a round back with raised bands; x across, back at z = 0 towards +z.
Mesh binding(const Volume& book) {
  Mesh mesh;
  for (const double side : {-1.0, 1.0})
    append(mesh, box("", {0.003F, book.tall, book.deep}),
           translation({side * (book.thick / 2.0 - 0.0015), book.tall / 2.0, -book.deep / 2.0}));
  const auto back = [&book](float u, float v) {
    const float angle = kPi * (1.0F - u);
    const float band = std::pow(std::max(0.0F, std::cos(2 * kPi * 4.0F * (v - 0.1F))), 12.0F);
    const float bulge = 0.18F * book.thick + 0.0015F * band;
    return Vec3{0.5F * book.thick * std::cos(angle), book.tall * v, bulge * std::sin(angle)};
  };
  append(mesh, tessellate("", back, {6, 14, Around::Open, {1.0F, 1.0F}}));
  return mesh;
}

/// A block of leaves, hollow at its fore edge.
Mesh leaves(const Volume& book) {
  Mesh mesh = box("", {book.thick - 0.006F, book.tall - 0.008F, book.deep - 0.006F});
  for (Vec3& position : mesh.positions) {
    position += Vec3{0.0F, 0.5F * book.tall, -0.5F * book.deep};
  }
  return mesh;
}

Volume draw_volume(float height, Dice& dice) {
  const float tall = height * dice.in(0.66F, 0.98F);
  return {dice.in(0.016F, 0.055F), tall, tall * dice.in(0.62F, 0.75F)};
}

}  // namespace

void append(Books& books, const Books& more, const DMat4& at) {
  for (std::size_t i = 0; i < kBookColors; ++i) append(books.covers[i], more.covers[i], at);
  append(books.pages, more.pages, at);
}

Books row_of_books(float width, float height, std::uint64_t seed) {
  Dice dice(seed);
  Books books;
  float x = 0.0F;
  while (true) {
    const Volume book = draw_volume(height, dice);
    const bool gap = dice.chance(0.03F);
    x += gap ? 0.10F : 0.0F;
    if (x + book.thick > width) break;
    // After a gap a book leans on the ones before it.
    const double lean = gap ? 9.0 : 0.6 * (dice.next() - 0.5);
    const DMat4 at =
        translation({x + book.thick / 2.0, 0.0, -0.015 * dice.next()}) * rotation_z(Degrees{lean});
    append(books.covers[static_cast<std::size_t>(dice.below(kBookColors))], binding(book), at);
    append(books.pages, leaves(book), at);
    x += book.thick + 0.001F;
  }
  return books;
}

Books pile_of_books(int count, std::uint64_t seed) {
  Dice dice(seed);
  Books books;
  float y = 0.0F;
  for (int i = 0; i < count; ++i) {
    const Volume book = draw_volume(0.27F, dice);
    const DMat4 at = rotation_y(Degrees{50.0 * (dice.next() - 0.5)}) *
                     translation({-book.tall / 2.0, y + book.thick / 2.0, book.deep / 2.0}) *
                     rotation_z(Degrees{-90.0});
    append(books.covers[static_cast<std::size_t>(dice.below(kBookColors))], binding(book), at);
    append(books.pages, leaves(book), at);
    y += book.thick + 0.001F;
  }
  return books;
}

float shelf_height(int shelf) {
  return 0.12F + 0.37F * static_cast<float>(shelf);
}

Mesh bookcase(float width) {
  constexpr float kDepth = 0.32F, kBoard = 0.025F;
  const float top = shelf_height(kShelves) + 0.02F;
  Mesh mesh;
  mesh.name = "bookcase";
  const auto board = [&](const Vec3& size, const DVec3& centre) {
    append(mesh, box("", size, 0.8F), translation(centre));
  };
  for (int i = 0; i <= kShelves; ++i)
    board({width, kBoard, kDepth}, {0.0, shelf_height(i) - kBoard / 2.0, -kDepth / 2.0});
  for (const double side : {-1.0, 1.0})
    board({0.03F, top, kDepth}, {side * (width / 2.0 - 0.015), top / 2.0, -kDepth / 2.0});
  board({width, top, 0.01F}, {0.0, top / 2.0, -kDepth});
  board({width, 0.10F, kDepth - 0.03F}, {0.0, 0.05, -kDepth / 2.0 - 0.015});
  board({width + 0.06F, 0.05F, kDepth + 0.05F}, {0.0, top + 0.025, -kDepth / 2.0 + 0.02});
  // Fluted pilasters in front of the sides.
  const auto flutes = [top](float u, float v) {
    return Vec3{0.06F * (u - 0.5F), top * v, 0.012F - 0.006F * std::abs(std::sin(4.0F * kPi * u))};
  };
  for (const double side : {-1.0, 1.0})
    append(mesh, tessellate("", flutes, {32, 8, Around::Open, {0.1F, 2.0F}}),
           translation({side * (width / 2.0 - 0.015), 0.0, 0.0}));
  return mesh;
}

}  // namespace macula::scene::built_in
