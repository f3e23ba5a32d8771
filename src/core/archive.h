// Values as bytes: numbers as they lie in memory (little-endian), arrays and texts behind their
// count, structs field by field. The fields of a struct are those that `fields(archive, value)`
// names, once for writing and reading; it stands in the struct's namespace.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <type_traits>
#include <variant>

#include "burnish/error.h"

namespace burnish {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");

/// T or const T: what fields() takes.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

/// Stored as it lies in memory: numbers, and structs of numbers without gaps.
template <class T>
inline constexpr bool kPlainBytes = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T, std::size_t N>
inline constexpr bool kPlainBytes<std::array<T, N>> = kPlainBytes<T>;

template <class T>
concept Resizable = requires(T v) {
    v.resize(1);
    v.begin();
};
template <class T>
concept PlainArray = Resizable<T> && kPlainBytes<typename T::value_type> && requires(T v) {
    v.data();
};

/// Takes the next bytes.
using ByteSink = std::function<void(const void* from, std::size_t size)>;
/// Gives the next bytes.
using ByteSource = std::function<void(void* to, std::size_t size)>;

class ArchiveWriter {
  public:
    explicit ArchiveWriter(ByteSink sink) : sink_(std::move(sink)) {}

    template <class... T>
    void operator()(const T&... values) {
        (write(values), ...);
    }
    /// Of another archive, or entries of an array: no count before them.
    void raw(const void* from, std::size_t size) { sink_(from, size); }

  private:
    template <class T>
    void write(const T& v) {
        if constexpr (kPlainBytes<T>) {
            sink_(&v, sizeof v);
        } else if constexpr (PlainArray<T>) {
            write(std::uint64_t{v.size()});
            sink_(v.data(), v.size() * sizeof(typename T::value_type));
        } else if constexpr (Resizable<T>) {
            write(std::uint64_t{v.size()});
            for (const auto& item : v) write(item);
        } else if constexpr (requires { v.has_value(); }) {
            write(static_cast<std::uint8_t>(v.has_value()));
            if (v) write(*v);
        } else if constexpr (requires { v.index(); }) {
            write(static_cast<std::uint32_t>(v.index()));
            std::visit([this](const auto& own) { this->write(own); }, v);
        } else {
            fields(*this, v);
        }
    }

    ByteSink sink_;
};

/// Whose bytes are read: the caller's, or those that an exchange gave.
enum class BytesFrom { kInput, kExchange };

class ArchiveReader {
  public:
    /// what: in messages, "the state". What is wrong with the bytes is thrown as InputError, of an
    /// exchange as Error.
    ArchiveReader(std::string what, std::uint64_t size, ByteSource source,
                  BytesFrom from = BytesFrom::kInput)
        : what_(std::move(what)), size_(size), source_(std::move(source)), from_(from) {}

    template <class... T>
    void operator()(T&... values) {
        (read(values), ...);
    }
    /// Of another archive, or entries of an array: no count before them.
    void raw(void* to, std::size_t size) {
        if (size > left())
            fail(std::to_string(left()) + " bytes more", "at least " + std::to_string(size));
        if (size > 0) source_(to, size);
        at_ += size;
    }
    std::uint64_t left() const { return size_ - at_; }
    /// Alternative `index` of a variant, where the index has been read already.
    template <std::size_t I = 0, class Variant>
    void alternative(std::size_t index, Variant& v) {
        if constexpr (I < std::variant_size_v<Variant>) {
            if (index == I)
                read(v.template emplace<I>());
            else
                alternative<I + 1>(index, v);
        } else {
            fail("alternative " + std::to_string(index), "a known one");
        }
    }
    [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
        const std::string message =
            what_ + ", byte " + std::to_string(at_) + ": found " + found + ", expected " + expected;
        if (from_ == BytesFrom::kExchange) throw Error(message);
        throw InputError(message);
    }
    void require_end() const {
        if (left() > 0) fail(std::to_string(left()) + " bytes more", "the end");
    }

  private:
    /// The count of items that follow. No more than bytes that are left may hold: a wrong count
    /// allocates nothing.
    template <class Item>
    std::size_t count() {
        std::uint64_t n = 0, min = 0;
        raw(&n, sizeof n);
        ArchiveWriter{[&min](const void*, std::size_t size) { min += size; }}(Item{});
        if (n > left() / min)
            fail("an array of " + std::to_string(n) + " items",
                 "at most " + std::to_string(left() / min));
        return static_cast<std::size_t>(n);
    }
    template <class T>
    void read(T& v) {
        if constexpr (kPlainBytes<T>) {
            raw(&v, sizeof v);
        } else if constexpr (PlainArray<T>) {
            v.resize(count<typename T::value_type>());
            raw(v.data(), v.size() * sizeof(typename T::value_type));
        } else if constexpr (Resizable<T>) {
            v.resize(count<typename T::value_type>());
            for (auto& item : v) read(item);
        } else if constexpr (requires { v.has_value(); }) {
            std::uint8_t has = 0;
            read(has);
            if (has > 1) fail("flag " + std::to_string(has), "0 or 1");
            if (has) read(v.emplace());
        } else if constexpr (requires { v.index(); }) {
            std::uint32_t index = 0;
            read(index);
            alternative(index, v);
        } else {
            fields(*this, v);
        }
    }

    std::string what_;
    std::uint64_t size_, at_ = 0;
    ByteSource source_;
    BytesFrom from_;
};

/// Writes into a text.
inline ByteSink sink_into(std::string& bytes) {
    return [&bytes](const void* from, std::size_t size) {
        bytes.append(static_cast<const char*>(from), size);
    };
}

/// Reads a text, which must outlive it, from its begin on.
inline ByteSource source_of(const std::string& bytes) {
    return [&bytes, at = std::size_t{0}](void* to, std::size_t size) mutable {
        std::memcpy(to, bytes.data() + at, size);
        at += size;
    };
}

}  // namespace burnish
