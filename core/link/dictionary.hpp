// The messages in a board's data dictionary: names, ids and parameters.
#pragma once
#include <cstdint>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "link/frame.hpp"

namespace passo::wire {

// All integer types share one encoding; the type decides how the 32 bits are read, and which values
// a board accepts.
enum class Type : uint8_t { byte, unsigned_word, signed_word, unsigned_int, signed_int, blob };

struct Parameter {
  std::string name;
  Type type;
};

using Value = std::variant<int64_t, std::string>;

// One message as `name a=%u b=%*s` declares it.
struct Format {
  int32_t id;
  std::string name, text;
  std::vector<Parameter> parameters;

  // Throws std::invalid_argument if `text` is not a declaration.
  Format(int32_t id_, const std::string& text_);

  // Appends id and values. Throws std::invalid_argument when they do not match the declaration.
  void encode(const std::vector<Value>& values, Bytes& out) const;

  // Reads the values after the id; `in.ok` is false if the values are incomplete.
  void decode(Reader& in, std::vector<Value>& values) const;

 private:
  static bool is_signed(Type type) { return type == Type::signed_int || type == Type::signed_word; }
  static Type type_of(const std::string& conversion);
  static void put(Bytes& out, uint32_t value);
};

// All formats of one direction.
class Formats {
 public:
  void add(int32_t id, const std::string& text);
  const Format* find(int32_t id) const;
  const Format* find(const std::string& name) const;
  // Throws std::invalid_argument if the board does not have the message.
  const Format& at(const std::string& name) const;
  const std::vector<Format>& all() const { return list_; }

 private:
  std::vector<Format> list_;
  std::unordered_map<int32_t, size_t> by_id_;
  std::unordered_map<std::string, size_t> by_name_;
};

}  // namespace passo::wire
