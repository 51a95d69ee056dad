//! Where the mutants are in the syntax tree, and what is inserted there.

use crate::Mutant;
use crate::edit::Edit;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// Returns the insertions for mutants, which are given by the place at which they begin, and the
/// ids of the mutants that are written.
pub(crate) fn edits(
    text: &str,
    file: &syn::File,
    at: &BTreeMap<usize, Vec<&Mutant>>,
) -> (Vec<Edit>, BTreeSet<u32>) {
    let mut weaver = Weaver {
        text,
        at,
        edits: Vec::new(),
        written: BTreeSet::new(),
        depth: 1,
        constants: 0,
    };
    weaver.visit_file(file);
    (weaver.edits, weaver.written)
}

struct Weaver<'a> {
    text: &'a str,
    at: &'a BTreeMap<usize, Vec<&'a Mutant>>,
    edits: Vec<Edit>,
    written: BTreeSet<u32>,
    /// Depth of the current expression.
    depth: i32,
    /// Constants and constant functions around the current expression.
    constants: u32,
}

fn range(node: &impl Spanned) -> Range<usize> {
    node.span().byte_range()
}

impl Weaver<'_> {
    /// Mutants of a kind that begin at a place.
    fn mutants(&self, offset: usize, genre: &str) -> Vec<Mutant> {
        let all = self.at.get(&offset).into_iter().flatten();
        let wanted = all.filter(|mutant| mutant.genre == genre && self.constants == 0);
        wanted.map(|&mutant| mutant.clone()).collect()
    }

    fn source(&self, node: &impl Spanned) -> String {
        self.text[range(node)].to_owned()
    }

    /// Writes alternatives of an expression, each with the id of its mutant.
    fn choose(&mut self, whole: Range<usize>, alternatives: Vec<(u32, String)>) {
        if alternatives.is_empty() {
            return;
        }
        let mut before = String::from("(");
        for (id, text) in alternatives {
            before += &format!("if crate::mutant({id}) {{ {text} }} else ");
            self.written.insert(id);
        }
        before += "{ ";
        self.insert(whole.start, self.depth, before);
        self.insert(whole.end, -self.depth, String::from(" })"));
    }

    fn insert(&mut self, offset: usize, rank: i32, text: String) {
        self.edits.push(Edit { offset, rank, text });
    }

    fn binary(&mut self, binary: &syn::ExprBinary) {
        let [left, right] = [&binary.left, &binary.right].map(|side| self.source(side));
        let mutants = self.mutants(range(&binary.op).start, "BinaryOperator");
        let with = |mutant: Mutant| (mutant.id, format!("{left} {} {right}", mutant.replacement));
        let alternatives = mutants.into_iter().map(with).collect();
        self.choose(range(binary), alternatives);
    }

    fn unary(&mut self, unary: &syn::ExprUnary) {
        let inner = self.source(&unary.expr);
        let mutants = self.mutants(range(&unary.op).start, "UnaryOperator");
        let without = |mutant: Mutant| (mutant.id, inner.clone());
        let alternatives = mutants.into_iter().map(without).collect();
        self.choose(range(unary), alternatives);
    }

    /// A field without a value of its own has that of the rest.
    fn structure(&mut self, structure: &syn::ExprStruct) {
        let Some(rest) = &structure.rest else {
            return;
        };
        let rest = self.source(rest);
        for field in &structure.fields {
            let mutants = self.mutants(range(field).start, "StructField");
            if field.colon_token.is_none() {
                continue;
            }
            let name = self.source(&field.member);
            let of_rest = |mutant: Mutant| (mutant.id, format!("({rest}).{name}"));
            let alternatives = mutants.into_iter().map(of_rest).collect();
            self.choose(range(&field.expr), alternatives);
        }
    }

    /// An arm that never matches is as good as none.
    fn arm(&mut self, arm: &syn::Arm) {
        if let Some((_, guard)) = &arm.guard {
            let mutants = self.mutants(range(guard).start, "MatchArmGuard");
            let fixed = |mutant: Mutant| (mutant.id, mutant.replacement);
            let alternatives = mutants.into_iter().map(fixed).collect();
            self.choose(range(guard), alternatives);
        }
        for mutant in self.mutants(range(arm).start, "MatchArm") {
            let id = mutant.id;
            if let Some((_, guard)) = &arm.guard {
                let place = range(guard);
                self.insert(place.start, 0, format!("!crate::mutant({id}) && ("));
                self.insert(place.end, 0, String::from(")"));
            } else {
                let text = format!(" if !crate::mutant({id})");
                self.insert(range(&arm.pat).end, 0, text);
            }
            self.written.insert(id);
        }
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let Some(first) = block.stmts.first() else {
            return;
        };
        // Of an opaque type there is one only.
        let is_opaque = self.source(&signature.output).contains("impl ");
        for mutant in self.mutants(range(first).start, "FnValue") {
            if is_opaque {
                continue;
            }
            let (id, value) = (mutant.id, mutant.replacement);
            let text = format!(" if crate::mutant({id}) {{ return {value}; }}");
            self.insert(range(&block.brace_token.span.open()).end, -1000, text);
            self.written.insert(id);
        }
    }

    fn within(&mut self, is_constant: bool, visit: impl FnOnce(&mut Self)) {
        self.constants += u32::from(is_constant);
        visit(self);
        self.constants -= u32::from(is_constant);
    }
}

impl<'ast> Visit<'ast> for Weaver<'_> {
    fn visit_expr(&mut self, expr: &'ast syn::Expr) {
        match expr {
            syn::Expr::Binary(binary) => self.binary(binary),
            syn::Expr::Unary(unary) => self.unary(unary),
            syn::Expr::Struct(structure) => self.structure(structure),
            _ => {}
        }
        self.depth += 1;
        visit::visit_expr(self, expr);
        self.depth -= 1;
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        self.arm(arm);
        self.depth += 1;
        visit::visit_arm(self, arm);
        self.depth -= 1;
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.within(item.sig.constness.is_some(), |weaver| {
            weaver.function(&item.sig, &item.block);
            visit::visit_item_fn(weaver, item);
        });
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.within(item.sig.constness.is_some(), |weaver| {
            weaver.function(&item.sig, &item.block);
            visit::visit_impl_item_fn(weaver, item);
        });
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
        visit::visit_trait_item_fn(self, item);
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.within(true, |weaver| visit::visit_item_const(weaver, item));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.within(true, |weaver| visit::visit_impl_item_const(weaver, item));
    }

    fn visit_trait_item_const(&mut self, item: &'ast syn::TraitItemConst) {
        self.within(true, |weaver| visit::visit_trait_item_const(weaver, item));
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.within(true, |weaver| visit::visit_item_static(weaver, item));
    }

    fn visit_type_array(&mut self, array: &'ast syn::TypeArray) {
        self.within(true, |weaver| visit::visit_type_array(weaver, array));
    }

    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    fn visit_expr_const(&mut self, block: &'ast syn::ExprConst) {
        self.within(true, |weaver| visit::visit_expr_const(weaver, block));
    }
}
