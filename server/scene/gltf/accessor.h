// AccessorView: typed reading of a glTF accessor after every offset, stride and count was proven to
// lie inside its buffer. Borrowed from the Document, but for a sparse one, whose elements are put
// together in memory that copies share; cheap to copy.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include "server/scene/gltf/document.h"
#include "server/scene/scene.h"

namespace macula::scene::gltf {

/// What the use of an accessor allows.
struct Expected {
  const char* role;                       ///< "POSITION", "indices", ...
  int type;                               ///< TINYGLTF_TYPE_*
  std::initializer_list<int> components;  ///< TINYGLTF_COMPONENT_TYPE_*
};

class AccessorView {
 public:
  static Result<AccessorView> create(const Document& document, int accessor,
                                     const Expected& expected);

  std::size_t count() const { return count_; }
  /// Unsigned integers of one component.
  Index index(std::size_t element) const;
  /// One component; integers are normalised, unsigned ones to [0, 1], signed ones to [-1, 1], as
  /// glTF says of colours, texture coordinates and rotations.
  float component(std::size_t element, std::size_t component) const;
  Vec2 vec2(std::size_t element) const { return {component(element, 0), component(element, 1)}; }
  Vec3 vec3(std::size_t element) const {
    return {component(element, 0), component(element, 1), component(element, 2)};
  }

 private:
  using Bytes = std::vector<unsigned char>;
  static Result<AccessorView> create_dense(const Document& document,
                                           const tinygltf::Accessor& accessor,
                                           const std::string& place);
  static Result<AccessorView> create_sparse(const Document& document,
                                            const tinygltf::Accessor& accessor,
                                            const std::string& place);
  void own(Bytes bytes, std::size_t element);

  std::span<const unsigned char> bytes_;  ///< from the first element to the view's end
  std::shared_ptr<const Bytes> owned_;    ///< what bytes_ looks into; null: the Document's
  std::size_t count_ = 0, stride_ = 0;
  int component_type_ = 0;
};

/// The bytes of a buffer view, checked against its buffer.
Result<std::span<const unsigned char>> buffer_view_bytes(const Document& document, int buffer_view);

}  // namespace macula::scene::gltf
