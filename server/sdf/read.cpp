#include "server/sdf/read.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "server/sdf/read_object.h"

namespace macula::sdf {
namespace {

constexpr double kFarthest = 1e12;   // m
constexpr double kBrightest = 1e12;  // W/sr and the like
constexpr std::string_view kPatterns = "none, checker, noise, bricks, stripes";

class FieldReader {
 public:
  explicit FieldReader(Reading& reading) : reading_(reading) {}

  Field read(const JsonValue& root) {
    ObjectReader object(reading_, root, "the scene");
    field_.tracks.clear();
    reading_.tracks = &field_.tracks;
    read_settings(object);
    read_materials(object);
    read_lights(object);
    read_cameras(object);
    if (const JsonValue* definitions = object.find("define", JsonValue::Type::Object)) {
      for (const auto& [name, value] : definitions->members) definitions_[name] = &value;
    }
    if (const JsonValue* scene = object.required("scene", JsonValue::Type::Object))
      read_node(*scene, 0);
    object.finish();
    return std::move(field_);
  }

 private:
  void read_settings(ObjectReader& object) {
    field_.sky = Rgb(object.color("sky", DVec3{0.0}, kBrightest));
    field_.far_m = object.number("far", 1e3, 1e-12, kFarthest);
    field_.exposure_ev = object.number("exposure_ev", 0.0, -30.0, 30.0);
    object.text("comment", "");
  }

  void read_materials(ObjectReader& object) {
    const JsonValue* materials = object.find("materials", JsonValue::Type::Object);
    if (!materials || materials->members.empty()) {
      field_.materials.push_back({.name = "default"});
      return;
    }
    for (const auto& [name, value] : materials->members) {
      ObjectReader entry(reading_, value, "a material");
      Material material{.name = name};
      material.color = Rgb(entry.color("color", DVec3{0.8}, 1.0));
      material.second = Rgb(entry.color("second", DVec3{0.2}, 1.0));
      material.pattern = static_cast<Pattern>(entry.one_of("pattern", kPatterns, 0));
      material.pattern_size_m =
          static_cast<float>(entry.number("pattern_size", 1.0, 1e-12, kFarthest));
      material.roughness = static_cast<float>(entry.number("roughness", 1.0, 0.0, 1.0));
      material.metallic = static_cast<float>(entry.number("metallic", 0.0, 0.0, 1.0));
      material.emission = Rgb(entry.color("emission", DVec3{0.0}, kBrightest));
      entry.finish();
      field_.materials.push_back(material);
    }
  }

  void read_lights(ObjectReader& object) {
    for (const JsonValue* value : object.objects("lights")) {
      ObjectReader entry(reading_, *value, "a light");
      PointLight light;
      light.name = entry.text("name", "");
      light.position =
          entry.parameter({"position", Shape::Vector, std::nullopt, -kFarthest, kFarthest});
      light.intensity =
          entry.parameter({"intensity", Shape::Vector, std::nullopt, 0.0, kBrightest});
      entry.finish();
      field_.lights.push_back(light);
    }
    for (const JsonValue* value : object.objects("suns")) {
      ObjectReader entry(reading_, *value, "a sun");
      Sun sun;
      const DVec3 direction = entry.vector("direction", std::nullopt, -kFarthest, kFarthest);
      if (!(glm::length(direction) > 0.0) && reading_.sound())
        reading_.fail(*value, "direction must not be zero", "the way the light travels");
      sun.direction = Vec3(glm::normalize(direction));
      sun.irradiance = Rgb(entry.vector("irradiance", std::nullopt, 0.0, kBrightest));
      entry.finish();
      field_.suns.push_back(sun);
    }
  }

  void read_cameras(ObjectReader& object) {
    for (const JsonValue* value : object.objects("cameras")) {
      ObjectReader entry(reading_, *value, "a camera");
      Camera camera;
      camera.name = entry.text("name", "");
      camera.eye = entry.parameter({"eye", Shape::Vector, std::nullopt, -kFarthest, kFarthest});
      camera.target =
          entry.parameter({"target", Shape::Vector, std::nullopt, -kFarthest, kFarthest});
      camera.up = entry.vector("up", DVec3{0.0, 1.0, 0.0}, -1.0, 1.0);
      camera.vertical_fov = Degrees{entry.number("vertical_fov_deg", 60.0, 1.0, 179.0)};
      entry.finish();
      field_.cameras.push_back(camera);
    }
  }

  std::int32_t material_named(const std::string& name, const JsonValue& node) {
    std::string known;
    for (std::size_t i = 0; i < field_.materials.size(); ++i) {
      if (field_.materials[i].name == name) return static_cast<std::int32_t>(i);
      known += (known.empty() ? "" : ", ") + field_.materials[i].name;
    }
    const JsonValue* at = node.find("material");
    reading_.fail(at ? *at : node, "no material is called '" + name + "'", "one of " + known);
    return -1;
  }

  /// Appends the node behind its children and returns its index; 0 once something is wrong.
  std::uint32_t read_node(const JsonValue& value, std::size_t depth) {
    if (!reading_.sound()) return 0;
    if (depth > kMaxJsonDepth) {
      reading_.fail(value, "definitions use each other too deeply",
                    base::concat("at most ", kMaxJsonDepth, " levels and no circle"));
      return 0;
    }
    ObjectReader object(reading_, value, "a node");
    Node node;
    read_placement(object, value, node);
    if (const JsonValue* use = object.find("use", JsonValue::Type::String)) {
      read_use(*use, node, depth);
    } else if (const JsonValue* type = object.required("type", JsonValue::Type::String)) {
      read_kind(object, *type, node, depth);
    }
    object.finish();
    return append(std::move(node), value);
  }

  void read_placement(ObjectReader& object, const JsonValue& value, Node& node) {
    node.name = object.text("name", "");
    node.at = object.parameter({"at", Shape::Vector, 0.0, -kFarthest, kFarthest});
    node.rotate_deg = object.parameter({"rotate_deg", Shape::Vector, 0.0, -1e9, 1e9});
    node.scale = object.parameter({"scale", Shape::Scalar, 1.0, 1e-12, 1e12});
    if (object.find("lipschitz", JsonValue::Type::Number))
      node.lipschitz = object.number("lipschitz", 1.0, 1.0, 1e6);
    const std::string material = object.text("material", "");
    if (!material.empty()) node.material = material_named(material, value);
  }

  void read_use(const JsonValue& use, Node& node, std::size_t depth) {
    const auto found = definitions_.find(use.text);
    if (found == definitions_.end()) {
      std::string known;
      for (const auto& [name, definition] : definitions_)
        known += (known.empty() ? "" : ", ") + name;
      reading_.fail(use, "nothing is defined as '" + use.text + "'",
                    known.empty() ? "define it under \"define\"" : "one of " + known);
      return;
    }
    node.kind = Kind::Union;
    node.children.push_back(read_node(*found->second, depth + 1));
  }

  void read_kind(ObjectReader& object, const JsonValue& type, Node& node, std::size_t depth) {
    const KindRule* rule = find_kind(type.text);
    if (!rule) {
      std::string known;
      for (const KindRule& each : kind_rules())
        known += (known.empty() ? "" : ", ") + std::string(each.name);
      reading_.fail(type, "no node type is called '" + type.text + "'", "one of " + known);
      return;
    }
    node.kind = rule->kind;
    for (std::size_t i = 0; i < rule->parameters.size(); ++i)
      node.parameters[i] = object.parameter(rule->parameters[i]);
    check_shape(type, node);
    if (rule->arity == Arity::Primitive) return;
    const auto children = object.objects("of");
    if (children.empty() && reading_.sound())
      reading_.fail(type, "'" + type.text + "' works on nothing", "give nodes under \"of\"");
    for (const JsonValue* child : children) node.children.push_back(read_node(*child, depth + 1));
  }

  /// What the ranges of single numbers cannot say.
  void check_shape(const JsonValue& type, const Node& node) {
    if (!reading_.sound()) return;
    const auto& p = node.parameters;
    const bool constant = p[0].track < 0 && p[1].track < 0;
    if (node.kind == Kind::Plane && constant && !(glm::length(p[0].value) > 0.0))
      reading_.fail(type, "normal must not be zero", "a direction");
    if (node.kind == Kind::Cone && constant && !(p[0].value.x + p[1].value.x > 0.0))
      reading_.fail(type, "both radii are zero", "bottom_radius or top_radius above zero");
    if (node.kind == Kind::Repeat && !(glm::length(p[0].value) > 0.0))
      reading_.fail(type, "period is zero along every axis", "a length along at least one");
    if (node.kind == Kind::Repeat && (p[1].track >= 0 || p[2].track >= 0))
      reading_.fail(type, "first and last have no keys", "constant indices");
    for (int axis = 0; axis < 3 && node.kind == Kind::Repeat; ++axis) {
      if (!(p[1].value[axis] <= p[2].value[axis]))
        reading_.fail(type, "first must not be above last", "indices of cells, per axis");
    }
  }

  std::uint32_t append(Node node, const JsonValue& value) {
    if (field_.nodes.size() >= kMaxNodes)
      reading_.fail(value, "too many nodes", base::concat("at most ", kMaxNodes));
    if (reading_.sound()) field_.nodes.push_back(std::move(node));
    return reading_.sound() ? static_cast<std::uint32_t>(field_.nodes.size() - 1) : 0;
  }

  Reading& reading_;
  Field field_;
  std::map<std::string, const JsonValue*, std::less<>> definitions_;
};

}  // namespace

Result<Field> parse_field(std::string_view text, const std::string& name) {
  const Result<JsonValue> root = parse_json(text, name);
  if (!root) return forward(root);
  Reading reading(text, name);
  Field field = FieldReader(reading).read(*root);
  if (reading.error()) return tl::unexpected(*reading.error());
  field.name = name;
  return field;
}

Result<Field> read_field(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return base::bad_input("it cannot be opened", path, "a readable file");
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) return base::bad_input("it cannot be read", path, "a readable file");
  if (text.size() > kMaxFileBytes) {
    return base::bad_input("the file is too large", path,
                           base::concat("at most ", kMaxFileBytes >> 20, " MiB"));
  }
  return parse_field(text, path);
}

}  // namespace macula::sdf
