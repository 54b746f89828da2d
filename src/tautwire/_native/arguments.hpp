// Arrays and numbers that Python hands over, taken as they are: nothing is converted, because a
// converted array is a temporary copy, to which no result returns and no pointer may be kept.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace tautwire {

namespace nb = nanobind;

template <class T>
constexpr const char* kTypeName = nullptr;
template <>
inline constexpr const char* kTypeName<double> = "float64";
template <>
inline constexpr const char* kTypeName<std::int64_t> = "int64";
template <>
inline constexpr const char* kTypeName<bool> = "bool";

// Say what an object is: "float32 (3, 2), not contiguous".
inline std::string describe(nb::handle value) {
    nb::ndarray<nb::ro> array;
    if (!nb::try_cast(value, array, false))
        return std::string("a ") + nb::type_name(value.type()).c_str();
    const char* kind = "unknown";
    switch (static_cast<nb::dlpack::dtype_code>(array.dtype().code)) {
        case nb::dlpack::dtype_code::Int: kind = "int"; break;
        case nb::dlpack::dtype_code::UInt: kind = "uint"; break;
        case nb::dlpack::dtype_code::Float: kind = "float"; break;
        case nb::dlpack::dtype_code::Complex: kind = "complex"; break;
        case nb::dlpack::dtype_code::Bool: kind = "bool"; break;
        default: break;
    }
    std::string text = kind;
    if (text != "bool") text += std::to_string(array.dtype().bits);
    text += " (";
    bool contiguous = true;
    std::int64_t stride = 1;
    for (std::size_t i = array.ndim(); i-- > 0; stride *= static_cast<std::int64_t>(array.shape(i)))
        contiguous &= array.shape(i) <= 1 || array.stride(i) == stride;
    for (std::size_t i = 0; i < array.ndim(); ++i)
        text += (i ? ", " : "") + std::to_string(array.shape(i));
    text += array.ndim() == 1 ? ",)" : ")";
    return contiguous ? text : text + ", not contiguous";
}

// The arguments of one call; keeps their arrays alive until it ends.
class Arguments {
public:
    // Return the entries of a contiguous array; T is const where the array is only read.
    template <class T>
    T* array(nb::handle value, std::size_t size, const std::string& name) {
        using Entry = std::remove_const_t<T>;
        using Array = nb::ndarray<T, nb::c_contig, nb::device::cpu>;
        Array found;
        const bool fits = nb::try_cast(value, found, false) && found.size() == size &&
                          reinterpret_cast<std::uintptr_t>(found.data()) % alignof(Entry) == 0;
        if (!fits)
            throw nb::type_error((name + " is " + describe(value) + "; expected a " +
                                  (std::is_const_v<T> ? "" : "writable ") + "contiguous " +
                                  kTypeName<Entry> + " array of " + std::to_string(size) + " entries")
                                     .c_str());
        kept_.push_back(std::make_shared<Array>(found));
        return found.data();
    }
    template <class T>
    T* entry(const nb::dict& arguments, const char* name, std::size_t size) {
        return array<T>(arguments[name], size, name);
    }

    // Return the length of the first axis of an argument.
    static std::size_t length(const nb::dict& arguments, const char* name) {
        return nb::len(nb::object(arguments[name]));
    }

    template <class T>
    static T value(const nb::dict& arguments, const char* name) {
        T out;
        if (!nb::try_cast(arguments[name], out))
            throw nb::type_error((std::string(name) + " is " + describe(arguments[name]) + "; expected " +
                                  (std::is_same_v<T, bool> ? "True or False" : "a number"))
                                     .c_str());
        return out;
    }
    static double positive(const nb::dict& arguments, const char* name) {
        const double out = value<double>(arguments, name);
        if (!(out > 0.0 && std::isfinite(out)))
            throw nb::value_error((std::string(name) + " must be positive and finite").c_str());
        return out;
    }

private:
    std::vector<std::shared_ptr<void>> kept_;
};

// Refuse indices outside [0, count).
inline void check_indices(const std::int64_t* index, std::size_t size, std::int64_t count, const char* name) {
    for (std::size_t i = 0; i < size; ++i)
        if (index[i] < 0 || index[i] >= count)
            throw nb::value_error((std::string(name) + " holds " + std::to_string(index[i]) +
                                   "; expected 0 to " + std::to_string(count - 1))
                                      .c_str());
}

}  // namespace tautwire
