//! Finite volumes on Cartesian grids: fields, operators, direct pressure solvers and incompressible flow.
