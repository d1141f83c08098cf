#include "server/scene/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

template <class T>
T load(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    default:
      return 4;
  }
}

const char* type_name(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    default:
      return "VEC3";
  }
}

std::size_t component_count(int type) {
  return type == TINYGLTF_TYPE_SCALAR ? 1 : static_cast<std::size_t>(type);
}

Result<void> check_kind(const tinygltf::Accessor& accessor, const Expected& expected,
                        const std::string& place) {
  if (accessor.type != expected.type) {
    return base::bad_input(base::concat("wrong type for ", expected.role), place,
                           base::concat("it must be ", type_name(expected.type)));
  }
  const auto& allowed = expected.components;
  if (std::find(allowed.begin(), allowed.end(), accessor.componentType) == allowed.end()) {
    std::string list;
    for (const int component : allowed) list += base::concat(list.empty() ? "" : ", ", component);
    return base::bad_input(
        base::concat("component type ", accessor.componentType, " for ", expected.role), place,
        "allowed: " + list);
  }
  if (accessor.count == 0) return base::bad_input("count is 0", place, "at least 1");
  return {};
}

/// Zeros that a sparse accessor may stand for, bytes; more than any exporter's morph target takes.
constexpr std::size_t kMostZeros = std::size_t{1} << 26;

std::size_t element_size(const tinygltf::Accessor& accessor) {
  return component_size(accessor.componentType) * component_count(accessor.type);
}

/// `count` > 0 elements of a sparse accessor's part, packed from byte_offset on.
Result<std::span<const unsigned char>> packed_part(const Document& document, int buffer_view,
                                                   int byte_offset, std::size_t count,
                                                   std::size_t element, const std::string& place) {
  const auto bytes = buffer_view_bytes(document, buffer_view);
  if (!bytes)
    return base::bad_input(bytes.error().what, place + ", " + bytes.error().where,
                           bytes.error().remedy);
  const std::size_t size = bytes->size();
  const auto offset = static_cast<std::size_t>(byte_offset);
  if (byte_offset < 0 || offset > size || (size - offset) / element < count) {
    return base::bad_input(
        base::concat(count, " elements from byte ", byte_offset, " do not fit in the buffer view"),
        place, base::concat("the view has ", size, " bytes, an element takes ", element));
  }
  return bytes->subspan(offset, count * element);
}

std::uint32_t load_index(const unsigned char* from, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *from;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(from);
    default:
      return load<std::uint32_t>(from);
  }
}

/// Writes what the sparse accessor replaces into its elements, which lie packed in `bytes`.
Result<void> replace_elements(const Document& document, const tinygltf::Accessor& accessor,
                              const std::string& place, std::size_t element,
                              std::vector<unsigned char>& bytes) {
  const auto& sparse = accessor.sparse;
  const int type = sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    return base::bad_input(base::concat("sparse indices of component type ", type), place,
                           "allowed: 5121, 5123, 5125");
  }
  if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > accessor.count) {
    return base::bad_input(base::concat("sparse count ", sparse.count), place,
                           base::concat("1 to ", accessor.count));
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  const std::size_t each = component_size(type);
  const auto indices = packed_part(document, sparse.indices.bufferView, sparse.indices.byteOffset,
                                   count, each, place + ", sparse indices");
  if (!indices) return forward(indices);
  const auto values = packed_part(document, sparse.values.bufferView, sparse.values.byteOffset,
                                  count, element, place + ", sparse values");
  if (!values) return forward(values);
  std::size_t least = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = load_index(indices->data() + i * each, type);
    if (index < least || index >= accessor.count) {
      return base::bad_input(base::concat("sparse index ", index, " at place ", i), place,
                             base::concat("rising, below ", accessor.count));
    }
    least = index + 1;
    std::memcpy(bytes.data() + index * element, values->data() + i * element, element);
  }
  return {};
}

}  // namespace

Result<std::span<const unsigned char>> buffer_view_bytes(const Document& document,
                                                         int buffer_view) {
  const tinygltf::BufferView* view = find(document.model.bufferViews, buffer_view);
  if (!view) {
    return base::bad_input(base::concat("there is no buffer view ", buffer_view), document.path,
                           base::concat("there are ", document.model.bufferViews.size()));
  }
  const std::string place = document.place("buffer view", static_cast<std::size_t>(buffer_view));
  const tinygltf::Buffer* buffer = find(document.model.buffers, view->buffer);
  if (!buffer) {
    return base::bad_input(base::concat("there is no buffer ", view->buffer), place,
                           base::concat("there are ", document.model.buffers.size()));
  }
  const std::size_t size = buffer->data.size();
  if (view->byteOffset > size || view->byteLength > size - view->byteOffset) {
    return base::bad_input(base::concat("byteOffset ", view->byteOffset, " + byteLength ",
                                        view->byteLength, " passes the buffer's end"),
                           place, base::concat("the buffer has ", size, " bytes"));
  }
  return std::span(buffer->data).subspan(view->byteOffset, view->byteLength);
}

Result<AccessorView> AccessorView::create(const Document& document, int accessor_index,
                                          const Expected& expected) {
  const tinygltf::Accessor* accessor = find(document.model.accessors, accessor_index);
  if (!accessor) {
    return base::bad_input(
        base::concat(expected.role, " names accessor ", accessor_index), document.path,
        base::concat("there are ", document.model.accessors.size(), " accessors"));
  }
  const std::string place = document.place("accessor", static_cast<std::size_t>(accessor_index));
  if (const auto kind = check_kind(*accessor, expected, place); !kind) return forward(kind);
  return accessor->sparse.isSparse ? create_sparse(document, *accessor, place)
                                   : create_dense(document, *accessor, place);
}

Result<AccessorView> AccessorView::create_dense(const Document& document,
                                                const tinygltf::Accessor& accessor,
                                                const std::string& place) {
  const auto bytes = buffer_view_bytes(document, accessor.bufferView);
  if (!bytes)
    return base::bad_input(bytes.error().what, place + ", " + bytes.error().where,
                           bytes.error().remedy);

  const std::size_t element = element_size(accessor);
  const std::size_t given =
      document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
  const std::size_t stride = given == 0 ? element : given;
  if (stride < element) {
    return base::bad_input(base::concat("byteStride ", stride, " is shorter than an element"),
                           place, base::concat("at least ", element));
  }
  // count elements need (count - 1) * stride + element bytes; divided, so that nothing can
  // overflow.
  const std::size_t offset = accessor.byteOffset, size = bytes->size();
  if (offset > size || size - offset < element ||
      (size - offset - element) / stride < accessor.count - 1) {
    return base::bad_input(
        base::concat(accessor.count, " elements from byte ", offset,
                     " do not fit in the buffer view"),
        place, base::concat("the view has ", size, " bytes, an element takes ", stride));
  }
  AccessorView view;
  view.bytes_ = bytes->subspan(offset);
  view.count_ = accessor.count;
  view.stride_ = stride;
  view.component_type_ = accessor.componentType;
  return view;
}

void AccessorView::own(Bytes bytes, std::size_t element) {
  owned_ = std::make_shared<const Bytes>(std::move(bytes));
  bytes_ = *owned_;
  stride_ = element;
}

/// The dense part, or zeros where there is none, with some elements replaced.
Result<AccessorView> AccessorView::create_sparse(const Document& document,
                                                 const tinygltf::Accessor& accessor,
                                                 const std::string& place) {
  const std::size_t element = element_size(accessor);
  AccessorView view;
  view.count_ = accessor.count;
  view.component_type_ = accessor.componentType;
  Bytes bytes;
  if (accessor.bufferView >= 0) {
    const auto dense = create_dense(document, accessor, place);
    if (!dense) return forward(dense);
    bytes.reserve(accessor.count * element);  // no more than the buffer has
    for (std::size_t i = 0; i < accessor.count; ++i) {
      const unsigned char* at = dense->bytes_.data() + i * dense->stride_;
      bytes.insert(bytes.end(), at, at + element);
    }
  } else if (accessor.count > kMostZeros / element) {
    return base::bad_input(base::concat(accessor.count, " elements without a buffer view"), place,
                           base::concat("at most ", kMostZeros / element, " zeros"));
  } else {
    bytes.resize(accessor.count * element);
  }
  const auto replaced = replace_elements(document, accessor, place, element, bytes);
  if (!replaced) return forward(replaced);
  view.own(std::move(bytes), element);
  return view;
}

Index AccessorView::index(std::size_t element) const {
  MACULA_DCHECK(element < count_);
  return load_index(bytes_.data() + element * stride_, component_type_);
}

float AccessorView::component(std::size_t element, std::size_t component) const {
  MACULA_DCHECK(element < count_);
  const unsigned char* at = bytes_.data() + element * stride_;
  switch (component_type_) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return static_cast<float>(at[component]) / 255.0F;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return static_cast<float>(load<std::uint16_t>(at + 2 * component)) / 65535.0F;
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return std::max(static_cast<float>(static_cast<std::int8_t>(at[component])) / 127.0F, -1.0F);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return std::max(static_cast<float>(load<std::int16_t>(at + 2 * component)) / 32767.0F, -1.0F);
    default:
      return load<float>(at + 4 * component);
  }
}

}  // namespace macula::scene::gltf
