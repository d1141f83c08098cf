// TableWriter: fills a PlacedLightTable row by row. Rows are made in a page near at hand and go
// past the caches from there: nobody reads them before all are written, and a cache would first
// have to fetch what they replace. Internal to the room.
#pragma once

#include <array>

#include "server/lights/placed_light_table.h"

namespace macula::lights {

/// Rows on their way into a table.
struct RowPage {
  static constexpr std::size_t kRows = 64;
  std::array<PlacedLightRow, kRows> rows;
  std::size_t count = 0;
};

class TableWriter {
 public:
  /// In place of what the table holds, `most` rows or fewer; keeps its memory.
  TableWriter(PlacedLightTable& table, std::size_t most);

  /// Where the next row is to be written, every field of it.
  PlacedLightRow& next() { return page_.rows[page_.count]; }
  /// Takes it into the table; one that is not kept is overwritten.
  void keep(std::uint32_t triangle) {
    table_.triangle[written_ + page_.count] = triangle;
    if (++page_.count == RowPage::kRows) flush();
  }
  /// Rows taken so far.
  std::size_t size() const { return written_ + page_.count; }
  /// The table is whole.
  void finish();

 private:
  void flush();

  PlacedLightTable& table_;
  RowPage page_;
  std::size_t written_ = 0;
};

/// Rows from `first` on, their places and what is to be known of all lights.
void store_page(const RowPage& page, std::size_t first, PlacedLightTable& table);

}  // namespace macula::lights
