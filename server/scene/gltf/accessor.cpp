#include "server/scene/gltf/accessor.h"

#include <algorithm>
#include <cstring>

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
  if (accessor.sparse.isSparse) {
    return base::bad_input("sparse accessors are not read", place, "export without sparse storage");
  }
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
  const auto bytes = buffer_view_bytes(document, accessor->bufferView);
  if (!bytes)
    return base::bad_input(bytes.error().what, place + ", " + bytes.error().where,
                           bytes.error().remedy);

  const std::size_t element =
      component_size(accessor->componentType) * component_count(accessor->type);
  const std::size_t given =
      document.model.bufferViews[static_cast<std::size_t>(accessor->bufferView)].byteStride;
  const std::size_t stride = given == 0 ? element : given;
  if (stride < element) {
    return base::bad_input(base::concat("byteStride ", stride, " is shorter than an element"),
                           place, base::concat("at least ", element));
  }
  // count elements need (count - 1) * stride + element bytes; divided, so that nothing can
  // overflow.
  const std::size_t offset = accessor->byteOffset, size = bytes->size();
  if (offset > size || size - offset < element ||
      (size - offset - element) / stride < accessor->count - 1) {
    return base::bad_input(
        base::concat(accessor->count, " elements from byte ", offset,
                     " do not fit in the buffer view"),
        place, base::concat("the view has ", size, " bytes, an element takes ", stride));
  }
  AccessorView view;
  view.bytes_ = bytes->subspan(offset);
  view.count_ = accessor->count;
  view.stride_ = stride;
  view.component_type_ = accessor->componentType;
  return view;
}

Index AccessorView::index(std::size_t element) const {
  MACULA_DCHECK(element < count_);
  const unsigned char* at = bytes_.data() + element * stride_;
  switch (component_type_) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *at;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(at);
    default:
      return load<std::uint32_t>(at);
  }
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
