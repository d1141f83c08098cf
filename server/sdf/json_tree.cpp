#include "server/sdf/json_tree.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "shared/base/text.h"

namespace macula::sdf {
namespace {

/// Reads the text and tells how much of it the library has taken.
class CountingIterator {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = char;
  using pointer = const char*;
  using reference = const char&;
  using iterator_category = std::input_iterator_tag;

  CountingIterator(const char* at, const char** newest) : at_(at), newest_(newest) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    ++at_;
    *newest_ = at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) {
    return a.at_ == b.at_;
  }
  friend bool operator!=(const CountingIterator& a, const CountingIterator& b) { return !(a == b); }

 private:
  const char* at_;
  const char** newest_;
};

/// Builds the tree. The library calls back after each token; a token begins behind the one before
/// it, past spaces, commas and colons.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  const char** newest() { return &newest_; }
  JsonValue take() { return std::move(root_); }
  const std::optional<Error>& error() const { return error_; }

  bool null() override { return add(JsonValue::Type::Null) != nullptr; }
  bool boolean(bool value) override {
    JsonValue* added = add(JsonValue::Type::Boolean);
    if (added) added->boolean = value;
    return added != nullptr;
  }
  bool number_integer(number_integer_t value) override {
    return add_number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return add_number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return add_number(value); }
  bool string(string_t& value) override {
    JsonValue* added = add(JsonValue::Type::String);
    if (added) added->text = std::move(value);
    return added != nullptr;
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(JsonValue::Type::Object); }
  bool start_array(std::size_t) override { return open(JsonValue::Type::Array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    const std::size_t offset = next_token();
    if (open_.back()->find(value)) {
      return refuse(offset, "the key '" + value + "' stands here for the second time",
                    "remove one of the two");
    }
    open_.back()->members.push_back({std::move(value), {}});
    return true;
  }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& exception) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..."
    const std::string text = exception.what();
    const std::size_t colon = text.find(": ");
    return refuse(position == 0 ? 0 : position - 1,
                  colon == std::string::npos ? text : text.substr(colon + 2), "it must be JSON");
  }

 private:
  std::size_t next_token() {
    std::size_t at = consumed_;
    while (at < text_.size() && std::string_view(" \t\r\n,:").find(text_[at]) != std::string::npos)
      ++at;
    consumed_ = newest_ ? static_cast<std::size_t>(newest_ - text_.data()) : 0;
    return at;
  }
  JsonValue* add(JsonValue::Type type) {
    const std::size_t offset = next_token();
    if (++values_ > kMaxJsonValues) {
      refuse(offset, "too many values", base::concat("at most ", kMaxJsonValues));
      return nullptr;
    }
    JsonValue* value = &root_;
    if (!open_.empty() && open_.back()->type == JsonValue::Type::Array)
      value = &open_.back()->items.emplace_back();
    else if (!open_.empty())
      value = &open_.back()->members.back().value;
    value->type = type;
    value->offset = offset;
    return value;
  }
  bool add_number(double number) {
    JsonValue* added = add(JsonValue::Type::Number);
    if (added) added->number = number;
    return added != nullptr;
  }
  bool open(JsonValue::Type type) {
    JsonValue* added = add(type);
    if (!added) return false;
    if (open_.size() == kMaxJsonDepth) {
      return refuse(added->offset, "nested too deeply",
                    base::concat("at most ", kMaxJsonDepth, " levels"));
    }
    open_.push_back(added);
    return true;
  }
  bool close() {
    next_token();
    open_.pop_back();
    return true;
  }
  bool refuse(std::size_t offset, std::string what, std::string remedy) {
    if (!error_) error_ = Error{std::move(what), place_in(text_, offset, name_), std::move(remedy)};
    return false;
  }

  std::string_view text_;
  const std::string& name_;
  const char* newest_ = nullptr;
  std::size_t consumed_ = 0, values_ = 0;
  JsonValue root_;
  std::vector<JsonValue*> open_;  ///< a parent does not grow while its child is open
  std::optional<Error> error_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
  for (const auto& [name, value] : members) {
    if (name == key) return &value;
  }
  return nullptr;
}

std::string place_in(std::string_view text, std::size_t offset, const std::string& name) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column =
      newline == std::string_view::npos ? before.size() + 1 : before.size() - newline;
  return base::concat(name, ": line ", line, ", column ", column);
}

Result<JsonValue> parse_json(std::string_view text, const std::string& name) {
  TreeBuilder builder(text, name);
  try {
    const char* begin = text.data();
    const bool read = nlohmann::json::sax_parse(
        CountingIterator(begin, builder.newest()),
        CountingIterator(begin + text.size(), builder.newest()), &builder);
    if (read && !builder.error()) return builder.take();
  } catch (const std::exception& exception) {
    return base::bad_input(exception.what(), name, "it must be JSON");
  }
  if (builder.error()) return tl::unexpected(*builder.error());
  return base::bad_input("it cannot be read", name, "it must be JSON");
}

}  // namespace macula::sdf
