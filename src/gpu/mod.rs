//! stub
use crate::error::*;
pub struct Gpu;
pub enum Kind {
    Hardware,
    Software,
}
impl Gpu {
    pub fn open(_: Option<&str>) -> Result<Gpu> {
        Err(Error::Device { needed: "a".into(), found: "b".into() })
    }
    pub fn kind(&self) -> Kind {
        Kind::Software
    }
    pub fn adapter(&self) -> String {
        String::new()
    }
}
impl crate::walk::Engine for Gpu {
    fn run(
        &self,
        _: &crate::tables::SamplingTables,
        _: &crate::goniometer::Goniometer,
        _: &crate::walk::WalkPlan,
        _: &mut dyn FnMut(&crate::goniometer::Tally),
    ) -> Result<crate::goniometer::Tally> {
        unreachable!()
    }
}
