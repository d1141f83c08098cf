#include "server/lights/table_writer.h"

#include <limits>

namespace macula::lights {
namespace {

void resize(PlacedLightTable& table, std::size_t count) {
  table.rows.resize(count);
  table.triangle.resize(count);
  table.places.resize(count);
}

}  // namespace

TableWriter::TableWriter(PlacedLightTable& table, std::size_t most) : table_(table) {
  resize(table_, most);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  table_.low = Vec3{kInfinity}, table_.high = Vec3{-kInfinity};
  table_.brightest = 0.0F;
  table_.oriented = Oriented::No;
}

void TableWriter::flush() {
  store_page(page_, written_, table_);
  written_ += page_.count;
  page_.count = 0;
}

void TableWriter::finish() {
  flush();
  resize(table_, written_);
}

}  // namespace macula::lights
