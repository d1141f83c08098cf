// Runs tapes over batches of points in vectors: distances alone, or distances with gradient and
// material. Many points pass through each operation before the next, so that what an operation
// costs to find is shared. A point's result does not depend on the points beside it.
// Coordinates are relative to the program's eye, meters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "server/sdf/tape.h"
#include "shared/math/vec.h"

namespace macula::sdf {

/// Points a batch holds: a multiple of every vector's width.
inline constexpr std::size_t kBatch = 128;

struct alignas(64) PointBatch {
  float x[kBatch], y[kBatch], z[kBatch];

  void set(std::size_t i, const Vec3& p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
};
struct alignas(64) DistanceBatch {
  float at[kBatch];
};
struct alignas(64) SurfaceBatch {
  float distance[kBatch];
  float x[kBatch], y[kBatch], z[kBatch];  ///< gradient, as it comes: its length is at most 1
  std::int32_t material[kBatch];
};

/// Floats at a vector's alignment, grown but never shrunk.
class AlignedFloats {
 public:
  float* at_least(std::size_t count);

 private:
  struct Free {
    void operator()(float* block) const { ::operator delete[](block, std::align_val_t{64}); }
  };
  std::unique_ptr<float[], Free> block_;
  std::size_t size_ = 0;
};

/// The registers of one thread.
struct Registers {
  AlignedFloats points, distances;
  std::vector<std::int32_t> materials;
};

/// count <= kBatch. Entries up to the next multiple of 16 are read and overwritten too: make
/// batches zero before first use.
void evaluate(const Tape& tape, const PointBatch& points, std::size_t count, Registers& registers,
              DistanceBatch& out);
void evaluate_surface(const Tape& tape, const PointBatch& points, std::size_t count,
                      Registers& registers, SurfaceBatch& out);

/// Lanes of a recording.
inline constexpr std::size_t kRecordedPoints = 16;
/// Runs a recording tape over the first kRecordedPoints points. The recording of lane i adds i to
/// both pointers; it lives in `registers` until they are used again.
Recording record(const Tape& recording_tape, const PointBatch& points, Registers& registers);

/// One point: for tests and odd jobs.
float evaluate_at(const Tape& tape, const Vec3& point);

/// Lane operations that a whole run of the tape costs a point: additions, multiplications (one
/// fused multiply-add counts once), comparisons, square roots and selections of its formulas.
std::size_t operations_of(const Tape& tape);

}  // namespace macula::sdf
