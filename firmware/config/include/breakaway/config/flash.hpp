// These functions turn a node's description into what is flashed, and into the C++ header that an image is compiled
// with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/firmware/flashed_machine.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::config {

inline constexpr std::size_t most_axes = 8;

// These return the parts of a node as the loop is told them. They require node.loop and a drive. Real is float or
// double.
// Throws InputError with what is missing unless the node has a [loop] and every axis a [drive] and impulsive gains.
void require_runnable(const Node& node);
// The same, and where its drives are of another protocol than boards speak.
void require_flashable(const Node& node);
// Whether its drives are of protocol "odrive": the drives of a node are of one.
bool speaks_odrive(const Node& node);

firmware::LoopConfig loop_config(const Node& node);
template <class Real>
cia402::DriveConfig<Real> drive_config(const Axis& axis);
// The same of a drive of protocol "odrive".
template <class Real>
odrive::DriveConfig<Real> odrive_config(const Axis& axis);
template <class Real>
firmware::AxisLimits<Real> axis_limits(const Axis& axis);

template <class Real, class Kicks = law::BrakedKicks<Real>>
using AnyNode = firmware::FlashedNode<Real, most_axes, Kicks>;
// With the coast "work".
template <class Real>
using WorkNode = AnyNode<Real, law::WorkKicks<Real>>;

// With a [coupling]; machine_design.hpp makes it.
template <class Real>
using MachineNode = firmware::FlashedMachine<Real, most_axes>;

// Whether the axes of the node have the coast "work". Throws InputError where some have it and others have not.
bool is_by_work(const Node& node);

// Returns the node with its kick tables, not certified, for simulation. Requires node.loop, and of every axis a drive
// and impulsive gains. Throws InputError for numbers that the scalar type cannot hold. Real: float or double. The
// second is for a node that is_by_work(), the first for any other.
template <class Real>
AnyNode<Real> flashed(const Node& node);
template <class Real>
WorkNode<Real> flashed_by_work(const Node& node);

// Returns the node certified and under its checksum, as it is flashed. Throws InputError as require_certified(), and
// when firmware::verify() refuses the node for another reason. Of drives of protocol "odrive" it holds nothing: their
// odrive_config() is checked, and stands beside it.
AnyNode<float> certified(const Node& node, const std::vector<design::DesignReport>& reports);
WorkNode<float> certified_by_work(const Node& node, const std::vector<design::DesignReport>& reports);

// Throws InputError where the node is certified and could not be flashed all the same. One without a [loop] is a study
// of the ideal law, for which no drive is chosen yet.
void require_flashable(const Node& node, const std::vector<design::DesignReport>& reports);

// Returns the header: `inline constexpr breakaway::firmware::FlashedNode<float, N> node` in namespace
// breakaway::flashed, after a statement of what was certified and on which conditions. Numbers are hexadecimal, so that
// they are exact; the compiler checks the checksum and that nothing contradicts itself. `source`: the file, for the
// statement.
std::string node_header(const AnyNode<float>& flashed, const Node& node,
                        const std::vector<design::DesignReport>& reports);
std::string node_header(const WorkNode<float>& flashed, const Node& node,
                        const std::vector<design::DesignReport>& reports);
// With a FlashedMachine<float, N>.
std::string node_header(const MachineNode<float>& flashed, const Node& node,
                        const stability::MachineCertificate& certificate);

// Returns the law image of the node, as firmware/law_image.hpp lays it out, for breakaway/law.h.
std::vector<std::uint8_t> law_image(const AnyNode<float>& flashed);
std::vector<std::uint8_t> law_image(const WorkNode<float>& flashed);

// Returns a header in C that defines breakaway_law_image, the image as an array. from: the file that it was made of.
std::string law_image_header(const std::vector<std::uint8_t>& image, const std::string& from);

}  // namespace breakaway::config
