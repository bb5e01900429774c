//! Large generic code, compiled in this crate for two and three dimensions. Code with the dimension as a parameter is else
//! compiled anew in every crate and program that uses it, which takes minutes.
use std::any::Any;

/// `per_dimension!(self, Type, method(argument: its type, …) -> output)` calls `Type::<D>::method` as compiled here;
/// without `self` it calls a function that is no method. All types may contain D.
macro_rules! per_dimension {
    ($type:ident, $function:ident($($arg:ident: $of:ty),*) -> $out:ty) => {{
        let plane = {
            const D: usize = 2;
            fn call(($($arg,)*): ($($of,)*)) -> $out {
                $type::<D>::$function($($arg),*)
            }
            call
        };
        let space = {
            const D: usize = 3;
            fn call(($($arg,)*): ($($of,)*)) -> $out {
                $type::<D>::$function($($arg),*)
            }
            call
        };
        let out: $out = $crate::per_dimension::make(($($arg,)*), plane, space);
        out
    }};
    ($this:expr, $type:ident, $method:ident($($arg:ident: $of:ty),*) -> $out:ty) => {{
        let plane = {
            const D: usize = 2;
            fn call(this: &mut $type<D>, ($($arg,)*): ($($of,)*)) -> $out {
                this.$method($($arg),*)
            }
            call
        };
        let space = {
            const D: usize = 3;
            fn call(this: &mut $type<D>, ($($arg,)*): ($($of,)*)) -> $out {
                this.$method($($arg),*)
            }
            call
        };
        let out: $out = $crate::per_dimension::call($this, ($($arg,)*), plane, space);
        out
    }};
}
pub(crate) use per_dimension;

/// `a` as a `B`, which is another name for its type.
fn same<A: 'static, B: 'static>(a: A) -> B {
    let mut a = Some(a);
    match (&mut a as &mut dyn Any).downcast_mut::<Option<B>>().and_then(Option::take) {
        Some(b) => b,
        None => unreachable!("a grid has two or three dimensions"),
    }
}

/// Calls whichever method is that of a `T`.
pub(crate) fn call<T, A, R, T2, A2, R2, T3, A3, R3>(
    this: &mut T,
    args: A,
    plane: fn(&mut T2, A2) -> R2,
    space: fn(&mut T3, A3) -> R3,
) -> R
where
    (T, A, R): 'static,
    (T2, A2, R2): 'static,
    (T3, A3, R3): 'static,
{
    let this: &mut dyn Any = this;
    if let Some(this) = this.downcast_mut() {
        return same(plane(this, same(args)));
    }
    match this.downcast_mut() {
        Some(this) => same(space(this, same(args))),
        None => unreachable!("a grid has two or three dimensions"),
    }
}

/// Calls whichever function makes an `R`.
pub(crate) fn make<A, R, A2, R2, A3, R3>(args: A, plane: fn(A2) -> R2, space: fn(A3) -> R3) -> R
where
    (A, R): 'static,
    (A2, R2): 'static,
    (A3, R3): 'static,
{
    let is_plane = std::any::TypeId::of::<R>() == std::any::TypeId::of::<R2>();
    if is_plane { same(plane(same(args))) } else { same(space(same(args))) }
}
