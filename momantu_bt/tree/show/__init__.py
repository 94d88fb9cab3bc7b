"""Output of trees and skills: lines, pages, schemas, SARIF."""
